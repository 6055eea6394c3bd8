#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/placed_axes.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// Where nothing of an arm with linear joints tells how high its axes are, the target does: its
/// distance from the origin of the last frame, along the last axis, is the description's. Its level
/// is that origin's.
struct TargetLevel {
  Eigen::Vector3d at_mm = Eigen::Vector3d::Zero();
  /// Standard uncertainty along the last axis. A target that stands elsewhere across that axis than
  /// it is described may be as far off along it. In the robot's own frame the base gives the
  /// height, unless it lies elsewhere, or far higher than such a target does: then both may be so.
  double open_mm = 0;
};

/// `z`: the Z axes, one a joint, and `covariance` as for placed(). `specified`: empty or one row an
/// axis.
[[nodiscard]] TargetLevel target_level(const std::vector<std::optional<Axis>>& z,
                                       const Eigen::Vector3d& target_mm,
                                       const Eigen::MatrixXd& covariance, const Campaign& campaign,
                                       const std::vector<DhRow>& specified, double size_mm);

/// How the axes (direction, point; six rows an axis) change, seen from the base, with a mm by which
/// the target is higher than taken. The base goes along with b of a linear joint that follows.
[[nodiscard]] Eigen::VectorXd change_with_level(const PlacedAxes& at_level,
                                                const std::vector<DhRow>& specified,
                                                double size_mm);

}  // namespace identify
