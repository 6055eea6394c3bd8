#pragma once

#include <vector>

#include "identify/geometry/warning.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace identify {

/// Poses that were given more than once, in every digit, are counted once; the warning names them.
/// An orientation that stands beside each of several targets counts once, too.
[[nodiscard]] std::vector<Pose> without_copies(std::vector<Pose> poses,
                                               std::vector<Warning>& warnings);

/// What the poses contradict: themselves (`target_moved`, `pose_outliers`), or the arm
/// (`pose_misfit`, `unit_factor`, `frame_mirrored`, `joints_exchanged`, `angles_negated`), with the
/// mistake that explains it where one is found. Empty: nothing.
[[nodiscard]] std::vector<Warning> doubts_of(const PoseEstimate& found,
                                             const std::vector<Pose>& poses,
                                             const Campaign& campaign);

/// What people should know of poses that fit: single ones that are off (`pose_outliers`), an arm
/// that is another in the second half of them (`poses_drift`), targets that lie near an axis
/// (`target_near_axis`), few poses (`few_poses`).
[[nodiscard]] std::vector<Warning> advice_on(const PoseEstimate& found,
                                             const std::vector<Pose>& poses);

}  // namespace identify
