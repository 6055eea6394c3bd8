#pragma once

#include <optional>
#include <vector>

#include "identify/geometry/warning.hpp"
#include "identify/poses/pose_estimate.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// Poses that lie far from where their target is, and where another target of the tool is: the
/// names look exchanged (`targets_exchanged`). Told by the described arm, in which poses that lie
/// far off count little, or by the arm that the sweeps beside them told. Nothing: none does.
[[nodiscard]] std::optional<Warning> exchanged_targets(const PoseEstimate& found,
                                                       const std::vector<Pose>& poses,
                                                       const Campaign& campaign,
                                                       const ChainEstimate* sweeps);

}  // namespace identify
