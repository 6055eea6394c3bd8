#pragma once

#include <nlohmann/json_fwd.hpp>

#include "identify/chain/chain_estimate.hpp"

namespace sweepd {

/// What result.json tells of the chain estimator besides its table: how the fit ended, the noise it
/// found, and for each joint whether its angles were believed, and why.
[[nodiscard]] nlohmann::ordered_json chain_json(const identify::ChainEstimate& estimate);

}  // namespace sweepd
