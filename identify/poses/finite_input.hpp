#pragma once

#include <vector>

#include "identify/geometry/warning.hpp"
#include "identify/poses/pose.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// Takes out samples and poses with a number that is infinite or none, and sweeps of which nothing
/// stays. A warning says how many samples and poses. All others stay as they are.
void leave_out_not_finite(std::vector<Sweep>& sweeps, std::vector<Pose>& poses,
                          std::vector<Warning>& warnings);

}  // namespace identify
