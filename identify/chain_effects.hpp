#pragma once

#include <Eigen/Core>

#include "identify/chain_estimate.hpp"
#include "identify/chain_nodes.hpp"
#include "identify/mixed_model.hpp"

namespace identify {

/// Orders of a figure, from the first on.
inline constexpr Eigen::Index kFigureOrders = 8;

/// The variances of the effects' columns: own ones are a turn of each joint and three shifts,
/// shared ones the orders of the radial and then of the axial figure, a home's a turn of each joint.
[[nodiscard]] EffectVariances variances_of(const ChainEffects& effects, const ChainNodes& nodes);

}  // namespace identify
