#pragma once

#include <Eigen/Core>

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_nodes.hpp"
#include "identify/chain/mixed_model.hpp"

namespace identify {

/// Orders of a figure, from the first on, and of what angles are off by, from none on.
inline constexpr Eigen::Index kFigureOrders = 8;

/// The columns that a problem has: of effects that are zero in `shape` none. A unit's own are a
/// turn of each joint, three shifts, and three that grow from minus one at a stroke's least turn to
/// one at its greatest. Those of a group are the orders of each target's radial and then axial
/// figure, and behind them those of the joint's angle. A home's are a turn of each joint.
struct EffectColumns {
  EffectColumns(const ChainEffects& shape, const ChainNodes& nodes);
  Eigen::Index own = 0;
  Eigen::Index figure = 0;  ///< of one target
  Eigen::Index told = 0;
  Eigen::Index home = 0;
  std::size_t targets = 0;
  [[nodiscard]] Eigen::Index shared() const {
    return figure * static_cast<Eigen::Index>(targets) + told;
  }
};

/// The variances of these columns for `effects` at most those of the shape.
[[nodiscard]] EffectVariances variances_of(const ChainEffects& effects, const ChainNodes& nodes,
                                           const EffectColumns& columns);

}  // namespace identify
