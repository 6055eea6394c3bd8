#pragma once

#include "identify/chain/chain_table.hpp"
#include "identify/identification.hpp"

namespace identify {

/// Sets `dh_covariance` and `dh_budget` of a result whose `dh` is the chain's, from the axes of
/// that table.
void set_budget(Identification& found, const TableAxes& axes);

}  // namespace identify
