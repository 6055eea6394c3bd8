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

/// What a joint gives way under a load farther out: `rad` times the load's lever about it, in
/// `reach_mm`, beyond what it gives way at home (see sagged()).
struct ChainSag {
  std::size_t joint = 0;
  std::size_t load = 0;  ///< hangs on this axis; on the first target where there is no such axis
  /// Or where that is after a right angle about the joint: a link's weight is not on the line from
  /// its axis to the next.
  bool beside = false;
  double reach_mm = 0;
  double share =
      0;  ///< standard deviation of `rad` beforehand, in that of the joint that gives way most
  double rad = 0;
};

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
  std::vector<ChainSag> sags;  ///< none: rigid joints, or nothing is known of them
  /// How far the measuring device drifts from the middle of the campaign to its end, steadily: so
  /// much farther the target is seen.
  Eigen::Vector3d drift_mm = Eigen::Vector3d::Zero();

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

/// A chain's sags for joints that give way in proportion to `sag_rad`, one a joint: each joint by
/// the loads that it carries, which are taken to hang on the axes behind it and on the first
/// target, and its own link's also beside the next axis, in shares that nobody knows. Nothing where
/// the first joint that turns is not `known`: it stands upright, and tells which way weights pull.
/// Linear joints do not give way.
[[nodiscard]] std::vector<ChainSag> sags_of(const Chain& chain, const std::vector<bool>& known,
                                            const std::vector<double>& sag_rad);

/// Of each sag of the chain: the load's lever about the joint when the joints turned so far, less
/// that at home, in its reach. By virtual work it is how fast the load rises as the joint turns.
[[nodiscard]] std::vector<double> sag_levers(const Chain& chain, const Turns& turns);

/// How far the joints really turned, those that give way with what they sag by.
[[nodiscard]] Turns sagged(const Chain& chain, const Turns& turns);

}  // namespace identify
