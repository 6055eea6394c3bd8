#pragma once

#include <cstddef>
#include <vector>

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_fit.hpp"

namespace identify {

/// States a fit as axes: sets `chain`, `axes`, `covariance` and `parts` of the estimate, each axis
/// where the first target passes it. `known`, one a joint, tells which axes the fit was about; of
/// these an axis that is uncertain by more than a degree is none. Of the fit's targets the first
/// `targets` count. Reads `with_orientation` of the estimate.
void set_fitted_axes(ChainEstimate& estimate, const ChainFit& fit, const std::vector<bool>& known,
                     std::size_t targets);

}  // namespace identify
