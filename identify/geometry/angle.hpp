#pragma once

#include <numbers>

namespace identify {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;

/// A linear joint (a KUKA linear unit, a SCARA's third joint) is told in mm where others are told
/// in degrees. Everywhere in here it is carried as if its mm were degrees: a turn of one radian is
/// a way of this many mm along its axis, half a degree is half a millimetre, and 0.1 degrees a
/// second are 0.1 mm/s.
inline constexpr double kLinear_mm = 1 / kDegree;
inline constexpr double kArcsec = kDegree / 3600;

}  // namespace identify
