#pragma once

#include <vector>

#include "identify/chain/chain_fit.hpp"
#include "identify/chain/linearised_chain.hpp"

namespace identify {

/// By so much less the deviance has to be: of simulated arms of which no joint went along, the
/// likeliest that might have had 8.
inline constexpr double kWentAlong = 12;

/// The joint that most likely goes on while another one sweeps, as a servo that is not held does,
/// or as one that was moved along: beside all of the `effects`, or in place of them; and those that
/// do about as likely while that one sweeps. Empty where none is likelier by `kWentAlong` than what
/// has the deviance `here`, and than a joint that stood elsewhere meanwhile. `from`: a fit that
/// knows of none. `shape`: which effects there may be, with those joints that were found before.
[[nodiscard]] std::vector<ChainEffects::Along> likeliest_along(const FittedChain& from,
                                                               ChainNodes& nodes,
                                                               const ChainEffects& effects,
                                                               const ChainEffects& shape,
                                                               double here);

}  // namespace identify
