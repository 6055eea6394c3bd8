#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "identify/geometry/line.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {

/// How far each joint has turned from home, positive rotation, rad; a linear one has moved by
/// kLinear_mm times that.
using Turns = std::array<double, kMostJoints>;

/// A joint axis at home: rotation about the unit `direction` through the point, or, of a linear
/// joint, translation along it: the point says nothing then.
struct ChainAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  bool linear = false;

  /// What it does to what it carries.
  [[nodiscard]] Eigen::Isometry3d displacement(double turn) const;
};

/// What a joint gives way by under weight on a link behind it: `rad` times the weight's lever about
/// it beyond the lever at home (chain_sag.hpp).
struct ChainSag {
  std::size_t joint = 0;
  std::size_t link = 0;                            ///< that this joint turns
  Eigen::Vector3d arm = Eigen::Vector3d::UnitX();  ///< to the weight, unit, across the link's axis
  double share = 0;  ///< standard deviation of `rad` beforehand, in ChainEffects::sag_rad
  double rad = 0;
};

/// How a measuring device drifts: evenly, and in waves beside it, zero at the first and the last
/// sample, between which they go half to and fro, once, one and a half times, and twice.
inline constexpr Eigen::Index kDriftParts = 5;
/// What each part is multiplied by, `when` from -1 at the first sample to 1 at the last one.
using DriftTimes = Eigen::Matrix<double, kDriftParts, 1>;
[[nodiscard]] DriftTimes drift_times(double when);
/// How large a random walk's parts are, in the first one: its waves are 2 sqrt(2) / (k pi) of it
/// (Karhunen-Loeve expansion of the Brownian bridge).
[[nodiscard]] DriftTimes drift_of_walk();

/// Which joints have an axis.
template <class AnyAxis>
[[nodiscard]] std::vector<bool> known_of(const std::vector<std::optional<AnyAxis>>& axes) {
  std::vector<bool> known;
  known.reserve(axes.size());
  for (const auto& axis : axes) known.push_back(axis.has_value());
  return known;
}

/// A robot as a product of exponentials (Brockett 1984; Lynch & Park, Modern Robotics, eq. 4.14):
///   x(q) = exp(xi_1 q_1) ... exp(xi_n q_n) x(0),
/// where all joints stand at home for q = 0, and everything is in the measurement frame. The twist
/// of a linear joint is (v, w) = (kLinear_mm * direction, 0) (ibid., eq. 3.85).
struct Chain {
  std::vector<ChainAxis> axes;                         ///< joint 1 first
  std::vector<Eigen::Vector3d> targets_mm;             ///< the target points at home
  Eigen::Matrix3d tool = Eigen::Matrix3d::Identity();  ///< orientation of the tool at home
  /// How far each joint has turned from where it was locked when its angle says that it is there:
  /// less than what is printed can show. One a joint, or none: not at all.
  std::vector<double> zero_rad;
  /// Away from the earth, unit, which weights pull against; zero where that is not known.
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  std::vector<ChainSag> sags;  ///< none: rigid joints, or nothing is known of them
  /// How far the measuring device drifts, one part a column: so much farther the target is seen.
  Eigen::Matrix<double, 3, kDriftParts> drift_mm = Eigen::Matrix<double, 3, kDriftParts>::Zero();
  /// How else targets are seen before something was moved, once. With the device or the robot's
  /// base: shifted along the measurement frame's axes, mm, and turned about them and the first
  /// target at home, rad. And each target on the tool: shifted, mm, along the same axes at home.
  /// Empty: nothing was.
  Eigen::VectorXd move;
  [[nodiscard]] Eigen::Index move_numbers() const {
    return 6 + 3 * static_cast<Eigen::Index>(targets_mm.size());
  }
  /// How far a target at `position_mm`, which `rotation` has turned since home, is seen elsewhere
  /// by each number, one a column.
  [[nodiscard]] Eigen::Matrix3Xd by_move(std::size_t target, const Eigen::Vector3d& position_mm,
                                         const Eigen::Matrix3d& rotation) const;

  /// Where joints that turned so far carry what moves with the last of them.
  [[nodiscard]] Eigen::Isometry3d displacement(const Turns& turns) const;
  [[nodiscard]] Eigen::Vector3d target_mm(std::size_t target, const Turns& turns) const {
    return displacement(turns) * targets_mm[target];
  }
};

/// The parameters of a chain, as small changes from where it is: four an axis, joint 1 first
/// (turning the direction towards the first and second vector of `across`, rad; shifting the point
/// along them, mm), then the targets (mm), then a rotation of the tool in the measurement frame.
/// A linear joint's point changes nothing: its columns are zero.
struct ChainParameters {
  std::size_t joints = 0;
  std::size_t targets = 0;

  [[nodiscard]] Eigen::Index axis(std::size_t joint) const {
    return static_cast<Eigen::Index>(4 * joint);
  }
  [[nodiscard]] Eigen::Index target(std::size_t index) const {
    return static_cast<Eigen::Index>(4 * joints + 3 * index);
  }
  [[nodiscard]] Eigen::Index tool() const { return target(targets); }
  [[nodiscard]] Eigen::Index count(bool with_tool) const { return tool() + (with_tool ? 3 : 0); }
};

/// The chain after the change; `change` has `count(false)` or `count(true)` elements.
[[nodiscard]] Chain moved(const Chain& chain, const Eigen::VectorXd& change);

/// By what `moved` makes the other of one chain, nearly: `count(true)` elements. Both have the same
/// joints and targets.
[[nodiscard]] Eigen::VectorXd change_between(const Chain& from, const Chain& to);

/// A chain at one pose, and how position and orientation of a target change there. Rows 0-2:
/// position (mm); rows 3-5: rotation (rad) in the measurement frame.
class ChainPose {
 public:
  /// The chain must outlive the pose.
  explicit ChainPose(const Chain& chain);

  using Twist = Eigen::Matrix<double, 6, 1>;
  Eigen::Vector3d position_mm;
  Eigen::Matrix3d rotation;                ///< of the displacement
  std::array<Twist, kMostJoints> by_turn;  ///< a joint's column of the spatial Jacobian
  /// Columns in the order of ChainParameters; those of other targets are not written.
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_parameter;

  /// `by_parameter` is left alone unless asked for.
  void set(std::size_t target, const Turns& turns, bool with_parameters);

 private:
  const Chain* chain_;
  std::array<Eigen::Matrix<double, 3, 2>, kMostJoints> across_;  ///< of each axis
};

/// The first joint that turns, which is taken to stand upright. Nothing where none does.
[[nodiscard]] std::optional<std::size_t> first_turning(const Chain& chain);

/// How far the targets are from the axes at most; from those that are known.
[[nodiscard]] double reach_mm(const Chain& chain, const std::vector<bool>& known);

/// By how much a joint that is off moves a target, at most, for a radian: little where the targets
/// are near its axis.
[[nodiscard]] double lever_mm(const Chain& chain, std::size_t joint);

/// What was moved by more is a mistake, and none of the effects. Joints come home to hundredths of
/// a degree, which moves the target of a large arm as far.
[[nodiscard]] double most_move_mm(const Chain& chain, const std::vector<bool>& known);

}  // namespace identify
