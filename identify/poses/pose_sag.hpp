#pragma once

#include <vector>

#include "identify/poses/pose_estimate.hpp"

namespace identify {

/// How far joints give way under what they carry, as poses tell: rad, one a joint, as
/// Campaign::sag_rad. Wheels that are off, of joints that carry weight, count in it: few poses do
/// not tell them from weight.
[[nodiscard]] std::vector<double> sag_of(const PoseEstimate& found);

/// Whether a joint gives way by more than was taken for granted; of none, nothing was.
[[nodiscard]] bool gives_way_more(const std::vector<double>& sag_rad,
                                  const std::vector<double>& granted_rad);

}  // namespace identify
