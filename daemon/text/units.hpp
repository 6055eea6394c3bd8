#pragma once

#include <chrono>

#include "identify/geometry/angle.hpp"

namespace sweepd {

// Degrees on the wire and in files, radians inside identify: these are the border.

using identify::kDegree;
using identify::kPi;

/// Beyond what anyone measures in mm, degrees or seconds, and harmless to the numerics.
inline constexpr double kLargestMeasured = 1e12;

[[nodiscard]] constexpr double radians(double degrees) {
  return degrees * kDegree;
}
[[nodiscard]] constexpr double degrees(double radians) {
  return radians * (180 / kPi);
}
[[nodiscard]] constexpr double arcsec(double radians) {
  return 3600 * degrees(radians);
}

[[nodiscard]] constexpr double us(std::chrono::nanoseconds time) {
  return static_cast<double>(time.count()) / 1e3;
}
[[nodiscard]] constexpr double ms(std::chrono::nanoseconds time) {
  return static_cast<double>(time.count()) / 1e6;
}

}  // namespace sweepd
