#pragma once

#include <array>

#include "identify/correction/wrist_arm.hpp"

namespace sweepd {

// KUKA's S and T of a position, which tell its joints apart from others that reach it.

/// Set where the point was taught on a robot with a model of its own for accuracy.
inline constexpr unsigned kAbsolutelyAccurate = 16;

/// By bits 0 to 2 of S: the wrist's centre is behind axis 1; joint 3 is beyond the stretched arm;
/// joint 5 is negative.
[[nodiscard]] identify::Posture posture_of(unsigned status);

/// T: a bit for each angle, set where it is negative.
[[nodiscard]] unsigned turn_of(const std::array<double, 6>& angles_rad);

/// Angles between -180 and 180 degrees, or a whole turn off, by T. As on the controller, T is
/// nothing for angles within 2 degrees of zero.
[[nodiscard]] std::array<double, 6> turned_as(std::array<double, 6> angles_rad, unsigned turn);

}  // namespace sweepd
