#pragma once

#include <array>
#include <optional>

#include <Eigen/Geometry>

#include "identify/dh/dh.hpp"

namespace identify {

/// Which of its postures an arm is in.
struct Posture {
  bool overhead = false;  ///< the wrist's centre is behind the first axis, by the base's X
  bool bent_up = false;   ///< joint 3 stands on the positive side of the stretched arm
  bool flipped = false;   ///< joint 5 is negative

  bool operator==(const Posture&) const = default;
};

/// An arm of six joints that turn, whose axes 2 and 3 are parallel and whose last three meet in one
/// point: its inverse kinematics are closed (Pieper 1968; by Paden-Kahan subproblems, Murray, Li,
/// Sastry, A Mathematical Introduction to Robotic Manipulation, 3.3). Angles are the controller's,
/// rad; poses those of the frame after the last row in the base.
class WristArm {
 public:
  using Angles = std::array<double, 6>;

  /// Nothing where the arm is none.
  [[nodiscard]] static std::optional<WristArm> of(const Arm& arm);

  [[nodiscard]] Posture posture(const Angles& angles) const;
  /// Between -pi and pi. Nothing where the pose is out of reach in this posture. Close to a
  /// singular pose joints may be any of those that reach it.
  [[nodiscard]] std::optional<Angles> angles_at(const Eigen::Isometry3d& pose,
                                                const Posture& posture) const;
  /// How far joint 5 is from where axes 4 and 6 lie along each other.
  [[nodiscard]] double from_singular_rad(const Angles& angles) const;

 private:
  WristArm() = default;

  struct Axis {
    Eigen::Vector3d direction;  ///< along positive rotation
    Eigen::Vector3d point;
  };
  std::array<Axis, 6> axes_;  ///< where all angles are zero, in the base
  Eigen::Isometry3d frame_;   ///< after the last row, there
  Eigen::Vector3d wrist_;     ///< its centre, there
};

}  // namespace identify
