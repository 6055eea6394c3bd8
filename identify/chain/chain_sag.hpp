#pragma once

#include <vector>

#include "identify/chain/chain.hpp"

namespace identify {

/// A chain's sags for joints that give way by `sag_rad`, one a joint: each joint by the loads that
/// it carries, which are taken to hang on the axes behind it and on the first target, in shares
/// that nobody knows. Nothing where the first joint that turns is not `known`: it stands upright,
/// and tells which way weights pull. Linear joints do not give way.
[[nodiscard]] std::vector<ChainSag> sags_of(const Chain& chain, const std::vector<bool>& known,
                                            const std::vector<double>& sag_rad);

/// Of each sag of the chain: the load's lever about the joint when the joints turned so far, less
/// that at home, in its reach. By virtual work it is how fast the load rises as the joint turns.
[[nodiscard]] std::vector<double> sag_levers(const Chain& chain, const Turns& turns);

/// How far the joints really turned, those that give way with what they sag by.
[[nodiscard]] Turns sagged(const Chain& chain, const Turns& turns);

}  // namespace identify
