#pragma once

#include "identify/chain/chain.hpp"
#include "identify/chain/chain_nodes.hpp"

namespace identify {

/// Scales what locked joints' angles did during each stroke by the share of it that the target did,
/// where that is less than all of it: a joint that shakes by less than the last decimal is printed
/// in steps, and to follow those moves the prediction more than the joint moved. The share is the
/// slope of the positions over the readings, which is the best linear prediction of what an angle
/// did from what was printed (Fuller, Measurement Error Models, 1987, eq. 1.1.9). Readings that
/// scatter by more than a few of the `step_rad` that they are printed in are left alone. `chain`
/// and `noise`: of a first fit. Returns whether it scaled any.
bool discount_readings(ChainNodes& nodes, const Chain& chain, const ChainNoise& noise,
                       double step_rad);

}  // namespace identify
