#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_table.hpp"
#include "identify/chain/delay.hpp"
#include "identify/circle/circle_estimate.hpp"
#include "identify/poses/pose_estimate.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

enum class Status {
  complete,  ///< every joint has an axis, every number of the table is known, nothing is in doubt
  doubtful,  ///< the data contradict themselves, or what a built robot can be: see `doubts`
  partial,
  failed,  ///< no joint has one
};
[[nodiscard]] std::string_view text(Status status) noexcept;

/// Which estimator a result comes from: `poses` those of static poses, perhaps with a chain's
/// beside them. `axes`: none, the axes were given.
enum class Estimator { circle, chain, poses, axes };
[[nodiscard]] std::string_view text(Estimator estimator) noexcept;

/// Beside what the circles found, with the joints' axes by the best estimator.
struct Identification : CircleEstimate {
  Status status = Status::failed;
  std::string reason;                       ///< why not complete; empty if it is
  Estimator estimator = Estimator::circle;  ///< where `dh` and the joints' axes come from
  std::vector<DhEstimate> dh;               ///< one row a joint
  /// Of the numbers of `dh`, where they are the chain's: five rows a row (b, theta, a, alpha, beta,
  /// mm and rad), zero for what is not identified, but that of what hangs on the base's height (see
  /// base_height.hpp) as at the height where it is taken. Empty: not known.
  Eigen::MatrixXd dh_covariance;
  /// What each cause has of their variances.
  struct Share {
    Cause cause = Cause::noise;
    Eigen::VectorXd variances;
  };
  std::vector<Share> dh_budget;
  std::optional<ChainEstimate> chain;  ///< nothing where no axis was found to start from
  /// How many samples whose errors are alike are worth one, as far as is known.
  [[nodiscard]] double samples_per_independent() const {
    return chain ? chain->samples_per_independent : 1;
  }
  /// The target in the frame behind the last row, that row taken as specified (zero without a
  /// specified table). Its rotation is known where the next is.
  std::optional<Eigen::Isometry3d> tool;
  /// What the last row is where it leads to the Z axis of the tool's frame: needs orientations.
  std::optional<DhEstimate> row_to_tool;
  /// Nothing where the campaign does not tell it. Where it is significant, the chain had the angles
  /// as they were when the positions were taken; sweeps hold them as they were told.
  std::optional<Delay> delay;
  std::optional<PoseEstimate> poses;  ///< `chain` is the poses' then
  /// Where the measurement frame is a device's: b and theta of row 1 are by convention then.
  std::optional<RobotPose> robot_pose;
};

/// Complete and partial become doubtful where there are doubts. The first leads the reason, also
/// that of a result that failed.
void apply_doubts(Identification& found);

/// The engine: circles first, then the chain, which starts from them; `dh` and the joints' axes are
/// the chain's where it converged. Static `poses` of the same robot in the same frame, if any, are
/// fitted then, with what the sweeps told beside them. Sweeps in the order of time. Never throws
/// for what the data hold; numbers that are not finite are left out. Same data give same bits.
[[nodiscard]] Identification identify(std::vector<Sweep> sweeps, const Campaign& campaign,
                                      std::vector<Pose> poses = {});

/// A table is complete where every number of it is known. Where one is undetermined though no axis
/// is missing, the status becomes partial, and the reason and a warning (`undetermined`) name it.
void name_undetermined(Identification& found);

/// Where one sample of a sweep lies to the chain, the joints that did not sweep taken at their
/// measured angles.
struct SeenTurn {
  double turn_rad = 0;   ///< from home, at which the target is seen about the sweeping joint's axis
  double axial_mm = 0;   ///< distance along that axis from where the chain has the target
  double radial_mm = 0;  ///< distance across it; of a linear joint, these two are across it
  /// The controller's angle minus the one seen; nothing without angles.
  std::optional<double> angle_error_rad;
  std::optional<double> curve_rad;  ///< the smooth curve of that error there
};

/// For a sample with a position, of a sweep of `joint` at `target`. Nothing without the joint's
/// axis.
[[nodiscard]] std::optional<SeenTurn> seen_turn(const Identification& found, std::size_t joint,
                                                std::size_t target, const Sample& sample);

}  // namespace identify
