#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "identify/clock/motion_spans.hpp"

namespace identify {

/// No clock gains more on another, in seconds a second.
inline constexpr double kMostRate = 3e-4;

/// How a device's clock goes by a controller's: what it shows beyond it. Both in seconds.
struct ClockMatch {
  double ahead_s = 0;  ///< at `at_s`
  double sigma_s = 0;  ///< standard uncertainty
  double rate = 0;     ///< so many seconds a second it gains
  double rate_sigma = 0;
  double at_s = 0;          ///< of the controller's clock
  std::size_t matched = 0;  ///< motions that both saw
  std::size_t strange = 0;  ///< that only one saw, while the other looked

  [[nodiscard]] double device_s(double controller_s) const {
    return controller_s + ahead_s + rate * (controller_s - at_s);
  }
  [[nodiscard]] double controller_s(double device_s) const {
    return at_s + (device_s - ahead_s - at_s) / (1 + rate);
  }
};

/// What was found of two clocks.
struct ClockSearch {
  /// Those that fit about as well as the best, the best first: more than one is ambiguous.
  std::vector<ClockMatch> matches;
  std::string problem;  ///< why there is none: what was seen, what to do
};

/// Clocks match where a device and a controller saw the same motions, from rest to rest: whatever
/// the clocks' difference, hours or epochs, and a drift of up to `kMostRate`. Only how long
/// motions last and when they come is looked at, so that the arm need not be known. Deterministic.
[[nodiscard]] ClockSearch match_clocks(const Motion& device, const Motion& controller);

}  // namespace identify
