#pragma once

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/linearised_chain.hpp"

namespace identify {

/// How large those of the chain's random effects are that `shape` has, by restricted likelihood at
/// a linearisation: the mean square of each over all combinations of sizes that the data allow,
/// weighed by their likelihood, so that what the data cannot tell from zero, or from another
/// effect, is not taken for zero. `smallest_mm`, `reach_mm`: what is still seen of a stroke's mean
/// place, and how far the target is from the axes.
[[nodiscard]] ChainEffects effect_sizes(LinearisedChain& chain, const ChainEffects& shape,
                                        double smallest_mm, double reach_mm);

}  // namespace identify
