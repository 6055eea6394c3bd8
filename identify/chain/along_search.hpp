#pragma once

#include <vector>

#include "identify/chain/chain_fit.hpp"
#include "identify/chain/linearised_chain.hpp"

namespace identify {

/// The joint that most likely goes on while another one sweeps, as a servo that is not held does,
/// or as one that was moved along: beside all of the `effects`, or in place of them; and those that
/// do about as likely while that one sweeps. Empty where none brings the deviance below `below`, or
/// a joint that stood elsewhere meanwhile does about as well.
/// `from`: a fit that knows of none. `shape`: which effects there may be, with those joints that
/// were found before.
[[nodiscard]] std::vector<ChainEffects::Along> likeliest_along(const FittedChain& from,
                                                               ChainNodes& nodes,
                                                               const ChainEffects& effects,
                                                               const ChainEffects& shape,
                                                               double below);

}  // namespace identify
