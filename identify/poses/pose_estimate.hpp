#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain_estimate.hpp"
#include "identify/poses/arm_fit.hpp"
#include "identify/poses/observability.hpp"
#include "identify/poses/pose_drift.hpp"
#include "identify/poses/pose_effects.hpp"
#include "identify/poses/pose_fit.hpp"
#include "identify/poses/pose_step.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// Rows beyond the unknowns: fewer tell nothing of the noise.
inline constexpr Eigen::Index kSpareRows = 6;

/// What is left of poses, in mm: of the distances between seen and predicted.
struct Left {
  double mean_mm = 0;
  double rms_mm = 0;
  double most_mm = 0;
};
[[nodiscard]] Left left_of(const Eigen::VectorXd& distances_mm);

/// The middle one of the distances between seen and predicted.
[[nodiscard]] double middle_left_mm(const PoseFit& fit);

/// What remains when so much of the specified arm is let go.
struct PoseLevel {
  Freedom freedom = Freedom::frames;
  PlacedArm arm;
  Left left;  ///< of the poses that were fitted, outliers aside
};

/// What static poses tell of an arm, perhaps with sweeps beside them.
struct PoseEstimate {
  std::vector<Pose> poses;  ///< in the order of the fit's rows
  PoseFit fit;
  std::vector<EffectEvidence> effects;
  std::vector<PoseLevel> levels;  ///< from frames on; empty without a specified table
  Left left;                      ///< by the fit, outliers aside
  Observability observability;
  PoseDrift drift;  ///< in the order of `poses`
  PoseStep step;    ///< the same
  /// Covariance of the fit's parameters beside that of the fit: what drifted or was moved amid the
  /// poses, and what play leaves open of home.
  Eigen::MatrixXd beside;
  bool with_sweeps = false;
  /// How much larger the weights' sizes (PoseNoise) may be than they are told to be (pose_sag.hpp).
  double weights_unsure_rad = 0;
  /// What the middle one would leave without the sweeps, for as many numbers; infinite where they
  /// are too few for an arm of their own.
  double left_alone_mm = std::numeric_limits<double>::infinity();
  /// What is left is no more than printing takes away, and looks like it: as far as anyone can
  /// tell, the positions were computed from the angles.
  bool computed = false;
  std::vector<std::size_t> outliers;  ///< poses that count less than half
  ChainEstimate chain;                ///< the fit's chain, with the axes that are certain enough

  /// Of all the fit's parameters, with all that makes them uncertain.
  [[nodiscard]] Eigen::MatrixXd whole_covariance() const { return fit.whole_covariance() + beside; }
  /// Where a pose is predicted, and the standard uncertainty of what will be seen there: that of
  /// the model, and the noise of one pose.
  [[nodiscard]] Eigen::Matrix3d covariance_at(const Pose& pose) const;
};

/// `sweeps`: the chain of sweeps in the same frame, if there is one, with its `home_rad`. Nothing
/// where the poses do not allow it; then `reason` says why. Deterministic.
[[nodiscard]] std::optional<PoseEstimate> estimate_poses(
    const std::vector<Pose>& poses, const Campaign& campaign, const ChainEstimate* sweeps,
    const std::vector<std::optional<double>>& home_rad, std::string& reason);

}  // namespace identify
