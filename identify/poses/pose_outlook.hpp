#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/dh_extraction.hpp"
#include "identify/poses/pose_rows.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// How many static poses of one target an arm of so many joints needs at least.
[[nodiscard]] std::size_t fewest_poses(std::size_t joints);

/// What static poses will tell of an arm, said beforehand.
struct PoseOutlook {
  /// The specified table, with the standard uncertainties that an identification will state.
  std::vector<DhEstimate> dh;
  /// One a joint; nothing where the poses leave the axis uncertain by more than a degree.
  std::vector<std::optional<Axis>> axes;
  /// The largest standard uncertainty of a predicted position over a workspace, in its worst
  /// direction; metres and more where the poses leave it open.
  double displacement_mm = 0;
};

/// Looks ahead at poses of a specified arm whose target (`tool_mm`) a device will see, by the
/// Fisher information at the specified table. Joints are taken to turn as their angles tell, but
/// for `noise`.
class PoseForecast {
 public:
  PoseForecast(const Campaign& campaign, const PoseNoise& noise);

  /// A pose, linearised. Columns: four an axis and three of the target.
  [[nodiscard]] PoseRow row(const std::vector<double>& angles_rad) const;
  /// The same as d_optimal() wants it.
  [[nodiscard]] Eigen::MatrixXd candidate(const PoseRow& row) const;
  [[nodiscard]] PoseOutlook outlook(const std::vector<PoseRow>& poses,
                                    const std::vector<PoseRow>& workspace) const;

 private:
  Campaign campaign_;
  PoseNoise noise_;
  PoseModel model_;
};

/// Outlooks of other poses of the same arm, at least one, as one: variances are their means.
[[nodiscard]] PoseOutlook mean(const std::vector<PoseOutlook>& outlooks);

}  // namespace identify
