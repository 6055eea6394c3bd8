#pragma once

#include <vector>

#include "identify/poses/pose_estimate.hpp"

namespace identify {

/// Raises what joints are granted to give way by (rad, one a joint, as Campaign::sag_rad; of none,
/// nothing was) to what poses show. Wheels that are off, of joints that carry weight, count in it:
/// few poses do not tell them from weight. False where what was granted is enough, but for a fifth
/// or a second of arc.
[[nodiscard]] bool grant_sag(const PoseEstimate& found, std::vector<double>& granted_rad);

}  // namespace identify
