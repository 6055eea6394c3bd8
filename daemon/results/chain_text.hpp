#pragma once

#include <string>

#include "identify/chain/chain_estimate.hpp"

namespace sweepd {

/// How the chain's fit ended, and how far each joint's angles were believed, for people.
[[nodiscard]] std::string chain_text(const identify::ChainEstimate& estimate);

}  // namespace sweepd
