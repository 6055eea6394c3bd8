#pragma once

#include "identify/chain_fit.hpp"

namespace identify {

/// How large those of the chain's random effects are that `shape` has, by restricted likelihood at a
/// linearisation. The likelihood is looked at over the sizes of one effect after the other, from
/// several starts, so that no start decides; then each effect takes its mean over the likelihood:
/// a size that the data cannot tell from zero is not taken for zero.
/// `smallest_mm`, `reach_mm`: what is still seen of a stroke's mean place, and how far the target is
/// from the axes.
[[nodiscard]] ChainEffects effect_sizes(const LinearisedChain& chain, const ChainEffects& shape,
                                        double smallest_mm, double reach_mm);

}  // namespace identify
