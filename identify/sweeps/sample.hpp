#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "identify/geometry/angle.hpp"

namespace identify {

inline constexpr std::size_t kMostJoints = 12;

/// What was measured at one moment: where the target point was, and the joint angles where known.
struct Sample {
  double time_s = 0;
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();  ///< in the measurement frame
  /// Orientation of the tool: R = Rz(a) Ry(b) Rx(c). Compare rotations, never these three.
  std::array<double, 3> abc_rad{};
  /// The controller's actual angles; of a linear joint its way, mm * kDegree (see kLinear_mm).
  std::array<double, kMostJoints> angles_rad{};
  std::uint8_t joints = 0;  ///< how many of the angles are known; 0: none
  /// Another number once an external axis stands elsewhere.
  std::uint16_t external_place = 0;
  bool has_position = false;
  bool has_orientation = false;
};

/// The smallest change that the measured numbers can show: one unit of the last decimal that the
/// controller prints. Zero where numbers come at full precision.
struct Resolution {
  double position_mm = 0;
  double angle_rad = 0;
};

}  // namespace identify
