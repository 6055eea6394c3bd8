#pragma once

#include <cstddef>
#include <vector>

#include "identify/dh/joint_order.hpp"
#include "identify/sweeps/campaign.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// Orders of joints, one a turn, whose axes lie as the described arm's do.
struct FittingOrders {
  std::vector<JointOrder> fitting;
  bool undecided = false;  ///< so many agree in part that none is told
  bool elsewhere = false;  ///< they agree at another pose than at the home that is declared
};

/// At the first pose where any does: the home that the campaign declares, that of the description,
/// any other one. Of `least` to `most` of the turns, as many as agree. The campaign has a
/// description.
[[nodiscard]] FittingOrders fitting_orders(const std::vector<Turn>& turns, std::size_t least,
                                           std::size_t most, const Campaign& campaign);
/// Whether any of all turns does at home, as the campaign declares it, or else the description.
[[nodiscard]] bool fit_at_home(const std::vector<Turn>& turns, const Campaign& campaign);

/// How many joints turn, and do not slide.
[[nodiscard]] std::size_t turning_joints(const Arm& arm);

}  // namespace identify
