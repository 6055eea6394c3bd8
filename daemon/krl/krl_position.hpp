#pragma once

#include <array>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "daemon/krl/krl_data.hpp"
#include "identify/correction/wrist_arm.hpp"

namespace sweepd {

// A position as KRL has it: its frame, and S and T, which tell the joints apart from others that
// reach it.

/// X, Y, Z in mm and A, B, C in degrees, R = Rz(A) Ry(B) Rx(C). Throws KrlError where one is
/// missing, is no number or is beyond what a robot can have.
[[nodiscard]] Eigen::Isometry3d krl_frame(const KrlAggregate& aggregate);

/// The same of a text as "{X 0,Y 0,Z 115,A 0,B 0,C 0}", with or without braces.
[[nodiscard]] Eigen::Isometry3d krl_frame(std::string_view text);

/// "{X 1.2340,Y 0.0000,...}".
[[nodiscard]] std::string krl_frame_text(const Eigen::Isometry3d& frame);

/// How near B is to 90 or -90 degrees, in degrees: there A and C cannot be told apart.
[[nodiscard]] double from_gimbal_deg(const Eigen::Matrix3d& rotation);

/// One number of an aggregate. Throws KrlError.
[[nodiscard]] double krl_number(const KrlAggregate& aggregate, std::string_view field);

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
