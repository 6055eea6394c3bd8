#pragma once

#include <array>
#include <vector>

#include "identify/poses/arm_fit.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace simulation {

/// What is left of poses of one target when base and tool, zeros, lengths, and twists of a
/// specified arm are let go, one after the other: worked out apart from identify/poses, by
/// differences of homogeneous matrices that are multiplied here, and Levenberg-Marquardt. `start`
/// tells where base and target are about. `judged`: those that are judged, or others than were
/// fitted.
[[nodiscard]] std::array<identify::Left, identify::kFreedoms> levels_by_differences(
    const identify::PlacedArm& start, const std::vector<identify::Pose>& fitted,
    const std::vector<identify::Pose>& judged);

}  // namespace simulation
