#pragma once

#include <vector>

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/linearised_chain.hpp"

namespace identify {

/// Looks for joints that err far more than the others: whose arcs depart further from circles,
/// since a worn bearing or another joint bends them, or that do not stay where they were locked.
/// Sizes that all joints share would put too little on these and too much on the others. A joint's
/// own effect is larger where that is likelier by 10 in twice the logarithm of the restricted
/// likelihood; then the mean square over all sizes, weighed by their likelihood.
///
/// Sets `home_times`, `figure_times` and their gains of the sizes, whose common sizes stay.
/// `usual_home_times`: those of even joints, one a joint.
void find_uneven_joints(LinearisedChain& chain, const std::vector<double>& usual_home_times,
                        ChainEffects& sizes);

}  // namespace identify
