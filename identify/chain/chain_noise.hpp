#pragma once

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_nodes.hpp"

namespace identify {

/// The noise of single samples by variance components (Rao 1971, minimum norm quadratic
/// unbiased), none below `floor`, from what each stroke's own smooth curve leaves: what a stroke as
/// a whole is off by is no noise. `noise` is the last estimate, from which the weights come; angles
/// that are not used there stay so.
[[nodiscard]] ChainNoise estimate_noise(const Chain& chain, const ChainNodes& nodes,
                                        const ChainNoise& noise, const ChainNoise& floor,
                                        bool with_orientation);

/// Root of the mean squared distance of all samples from the chain, per degree of freedom: 1 where
/// `noise` is right and nothing else is wrong.
[[nodiscard]] double misfit(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise,
                            bool with_orientation);

}  // namespace identify
