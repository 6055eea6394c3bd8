#pragma once

#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "daemon/krl/krl_data.hpp"

namespace sweepd {

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

}  // namespace sweepd
