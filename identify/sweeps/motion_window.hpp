#pragma once

#include "identify/geometry/angle.hpp"

namespace identify {

// How streams are looked at, whatever tells motion in them: the same for angles and positions.

/// Speed is that over so much before and after.
inline constexpr double kHalfWindow_s = 0.1;
/// A longer gap ends a stroke.
inline constexpr double kLongestGap_s = 0.25;
/// Less is motion, but no stroke.
inline constexpr double kShortestStroke_rad = 0.5 * kDegree;
/// The ends of a stroke that cover less than this share of it are rest, seen through the window.
inline constexpr double kRest = 5e-4;

}  // namespace identify
