#pragma once

#include <vector>

#include "identify/circle/circle_estimate.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// The paper's method (estimator `circle`): a circle for each joint's sweeps at the common home,
/// the axes as lines, the DH table from their common normals. Never throws for what the data hold:
/// what cannot be determined is left out; why a joint has no circle is said (why a circle gave no
/// axis, by add_advice). Deterministic.
[[nodiscard]] CircleEstimate estimate_circles(std::vector<Sweep> sweeps, const Campaign& campaign);

}  // namespace identify
