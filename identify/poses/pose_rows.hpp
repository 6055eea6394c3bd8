#pragma once

#include <vector>

#include <Eigen/Core>

#include "identify/poses/pose_model.hpp"

namespace identify {

/// Standard deviations of what a pose shows, each a component of its covariance
///   V = position^2 I + joint^2 J J^T, with the orientation's rows beside it,
/// where J is how the target moves with the joints that stand where they do in no other stand. What
/// a joint is off at a place of several stands is a parameter, as large beforehand.
struct PoseNoise {
  double position_mm = 0;      ///< of each coordinate
  double orientation_rad = 0;  ///< about each direction
  /// Of each joint's angle from what is told, anew at every place: backlash, gears, the servo.
  double joint_rad = 0;
  double gears_rad = 0;    ///< of the sizes of effects once and twice a turn that are assumed
  double weights_rad = 0;  ///< of those of weights
  double play_rad = 0;     ///< of the sizes of play: of half of what joints play by

  /// Of the sizes of such an effect where it is assumed.
  [[nodiscard]] double assumed_rad(JointEffect::Kind kind) const {
    if (kind == JointEffect::Kind::weight) return weights_rad;
    return kind == JointEffect::Kind::play ? play_rad : gears_rad;
  }

  /// Of what a row shows; `by_own` as in PoseRow.
  [[nodiscard]] Eigen::MatrixXd covariance(const Eigen::MatrixXd& by_own) const;
};

/// A pose, linearised at a model. Rows: position (mm), then, where it was measured, a rotation of
/// the tool in the measurement frame (rad).
struct PoseRow {
  Eigen::VectorXd off;           ///< seen less the model's
  Eigen::MatrixXd by_parameter;  ///< one column a parameter of the model
  Eigen::MatrixXd by_joint;      ///< one column a joint, as it turns
  Eigen::MatrixXd by_own;        ///< the same, zero for joints at a place of the model or at home
};

/// How far `left` of a row is from nothing, in standard deviations of its noise, as if the row were
/// a position alone: root of the sum of squares.
[[nodiscard]] double sigmas_of(const PoseNoise& noise, const PoseRow& row,
                               const Eigen::VectorXd& left);

/// Torques count as those of the chain as it is: how they change with it is of second order.
/// `with_orientation`: the orientation too, of poses that have one.
[[nodiscard]] PoseRow pose_row(const PoseModel& model, const Pose& pose, bool with_orientation);

/// Covariance of where play has a pose's position: of joints of which nobody knows in which sense
/// they came to rest, and which the model takes to be in the middle.
[[nodiscard]] Eigen::Matrix3d play_covariance(const PoseModel& model, const Pose& pose,
                                              const PoseRow& row);

/// How a pose changes with these effects' sizes, a column each.
[[nodiscard]] Eigen::MatrixXd effect_columns(const PoseModel& model,
                                             const std::vector<JointEffect>& effects,
                                             const Pose& pose, const PoseRow& row);

}  // namespace identify
