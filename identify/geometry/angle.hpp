#pragma once

#include <cmath>
#include <numbers>

namespace identify {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;

/// The same turn the short way, half a turn at most: std::remainder(), which is slow, for those few
/// that need it.
[[nodiscard]] inline double short_way(double turn_rad) {
  return std::abs(turn_rad) <= kPi ? turn_rad : std::remainder(turn_rad, 2 * kPi);
}

/// A linear joint (a KUKA linear unit, a SCARA's third joint) is told in mm where others are told
/// in degrees. Everywhere in here it is carried as if its mm were degrees: a turn of one radian is
/// a way of this many mm along its axis, half a degree is half a millimetre, and 0.1 degrees a
/// second are 0.1 mm/s.
inline constexpr double kLinear_mm = 1 / kDegree;
inline constexpr double kArcsec = kDegree / 3600;

}  // namespace identify
