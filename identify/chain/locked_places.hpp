#pragma once

#include <vector>

#include "identify/chain/chain_nodes.hpp"

namespace identify {

/// How far each joint may have stood from the home that was printed: where its angle hardly changed
/// while it was locked, up to half a step of the last decimal; where it wobbled through the steps,
/// their mean tells.
[[nodiscard]] std::vector<double> unseen_zeros(const ChainNodes& nodes, double angle_step_rad);

/// By how much each locked joint stood elsewhere from stroke to stroke than the chain takes it to,
/// as printed angles differ: by what they hide (at most `unseen`, from unseen_zeros()), and of a
/// joint of which no axis is known by what they tell. Standard deviations; none where no angle
/// differs, and where all axes are known, as then positions tell (`home_rad`).
[[nodiscard]] std::vector<double> untold_places(const ChainNodes& nodes,
                                                const std::vector<double>& unseen,
                                                double angle_step_rad);

}  // namespace identify
