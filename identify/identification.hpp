#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "identify/axis_senses.hpp"
#include "identify/bounding_box.hpp"
#include "identify/chain_estimate.hpp"
#include "identify/circle_fit.hpp"
#include "identify/dh.hpp"
#include "identify/dh_extraction.hpp"
#include "identify/joint_assignment.hpp"
#include "identify/line_fit.hpp"
#include "identify/motion_limit.hpp"
#include "identify/sweep.hpp"
#include "identify/warning.hpp"

namespace identify {

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
  /// The samples' times are times; else they are only an order.
  bool timed = true;
};

/// How late the controller's angles are against the positions.
struct Delay {
  double late_s = 0;   ///< at `at_s`: the angles told at t are those of t - late
  double sigma_s = 0;  ///< standard uncertainty
  double rate = 0;     ///< so many seconds a second it grows: clocks that differ; 0: not seen to
  double at_s = 0;     ///< in the campaign's time
};

enum class Status {
  complete,  ///< every joint has an axis, every number of the table is known, nothing is in doubt
  doubtful,  ///< the data contradict themselves, or what a built robot can be: see `doubts`
  partial,
  failed,  ///< no joint has one
};
[[nodiscard]] std::string_view text(Status status) noexcept;

/// Which estimator a result comes from. `axes`: none, the axes were given.
enum class Estimator { circle, chain, axes };
[[nodiscard]] std::string_view text(Estimator estimator) noexcept;

/// Where the robot's base stands in the measurement frame.
struct RobotPose {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Vector3d position_sigma_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_sigma_rad =
      Eigen::Vector3d::Zero();  ///< about the measurement frame's X, Y, Z
};

struct JointResult {
  std::vector<Sweep> sweeps;        ///< all of this joint, in the order of time
  std::vector<bool> used;           ///< one a sweep: at the common home, and no positioning
  std::optional<CircleFit> circle;  ///< of the used sweeps of one target
  std::size_t circle_target = 0;
  /// By the description or the strokes, the joint moves along a line: what is in rad of it (home,
  /// ranges, its angles' errors) is mm * kDegree.
  bool linear = false;
  std::optional<LineFit> line;          ///< in place of the circle
  SenseBy sense_by = SenseBy::nothing;  ///< what tells which way is positive
  /// Along positive rotation (of a linear joint, the way that its mm rise), by the best estimator.
  std::optional<Axis> axis;
  std::optional<BoundingBox> box;  ///< of the samples that were used
};

struct Identification {
  Status status = Status::failed;
  std::string reason;  ///< why not complete; empty if it is
  std::string doubt;   ///< why a table with all its numbers is not complete; empty: nothing
  /// One a joint, where known: the angles at which the axes below were locked.
  std::vector<std::optional<double>> home_rad;
  std::vector<JointResult> joints;
  Estimator estimator = Estimator::circle;  ///< where `dh` and the joints' axes come from
  std::vector<DhEstimate> dh;               ///< one row a joint
  /// Of the numbers of `dh`, where they are the chain's: five rows a row (b, theta, a, alpha, beta,
  /// mm and rad), zero for what is not identified. Empty: not known.
  Eigen::MatrixXd dh_covariance;
  /// What each cause has of their variances.
  struct Share {
    Cause cause = Cause::noise;
    Eigen::VectorXd variances;
  };
  std::vector<Share> dh_budget;
  std::vector<DhEstimate> circle_dh;   ///< the paper's, beside it
  std::optional<ChainEstimate> chain;  ///< nothing where no axis was found to start from
  std::vector<DhRow> specified;        ///< at home_rad; empty without a specified table
  /// The target in the frame behind the last row, that row taken as specified (zero without a
  /// specified table). Its rotation is known where the next is.
  std::optional<Eigen::Isometry3d> tool;
  /// What the last row is where it leads to the Z axis of the tool's frame: needs orientations.
  std::optional<DhEstimate> row_to_tool;
  /// Nothing where the campaign does not tell it. Where it is significant, the chain had the angles
  /// as they were when the positions were taken; sweeps hold them as they were told.
  std::optional<Delay> delay;
  /// Where the measurement frame is a device's: b and theta of row 1 are by convention then.
  std::optional<RobotPose> robot_pose;
  std::optional<BoundingBox> bounding_box;  ///< of the samples that were used
  /// What contradicts itself or what a built robot can be; the heaviest first.
  std::vector<Warning> doubts;
  std::vector<Warning> warnings;
};

/// Complete and partial become doubtful where there are doubts; the first leads the reason.
void apply_doubts(Identification& found);

/// The engine: circles first, then the chain, which starts from them; `dh` and the joints' axes are
/// the chain's where it converged. Sweeps in the order of time. Never throws for what the data
/// hold. The same sweeps give the same bits.
[[nodiscard]] Identification identify(std::vector<Sweep> sweeps, const Campaign& campaign);

}  // namespace identify
