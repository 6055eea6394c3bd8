#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identify/dh/dh.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {

/// A joint's turn in a campaign, as declared by a sweep plan.
struct DeclaredJoint {
  std::size_t joint = 0;  ///< counted from 0
  /// Of the first stroke, positioning included: +1 where the angle rises, -1 where it falls.
  int first_direction = 0;  ///< 0: unknown; the first stroke's is then taken as +1
  /// Every stroke of the turn, ways from and to home included: positive where the angle rises.
  /// Empty: not known.
  std::vector<double> strokes_rad = {};
};

/// A body that hangs on the arm.
struct Load {
  double mass_kg = 0;
  std::size_t joint = 0;  ///< the last one that moves it
  /// Its centre of mass in the frame after that joint's row.
  Eigen::Vector3d center_mm = Eigen::Vector3d::Zero();
};

/// What is known beforehand.
struct Campaign {
  std::size_t joints = 6;        ///< of the arm, 1 to kMostJoints
  std::optional<Arm> specified;  ///< with as many rows; the result is compared with it
  /// Where no angles are known: whose turn it was, in order. Empty: joint 1 to n.
  std::vector<DeclaredJoint> order;
  /// Where no angles are known: the angles of the locked joints, if declared.
  std::vector<double> declared_home_rad;
  Resolution resolution;
  /// Of the streams without angles in which the sweeps were recognised; the worst.
  std::optional<MotionLimit> motion_limit = {};
  /// The measurement frame is some device's: where the robot stands in it is part of the result.
  bool device_frame = false;
  /// Standard deviation of what each joint gives way by under the weight that it carries, at its
  /// worst pose, where a device measures the arm; one a joint, or none: nothing is known.
  std::vector<double> sag_rad;
  /// Bodies that hang on the arm, where they are known: what gears give way to.
  std::vector<Load> loads = {};
  /// Which way is up in the base of the specified arm, unit: another one than Z where it is mounted
  /// to a wall or a ceiling.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  /// The samples' times are times; else they are only an order.
  bool timed = true;
  /// Positions and angles come from two devices, each with a clock of its own.
  bool two_clocks = false;
};

}  // namespace identify
