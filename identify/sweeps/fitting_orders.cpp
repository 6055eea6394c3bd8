#include "identify/sweeps/fitting_orders.hpp"

#include <optional>
#include <utility>

namespace identify {
namespace {

using Home = std::optional<std::vector<double>>;

std::vector<Axis> axes_of(const std::vector<Turn>& turns) {
  std::vector<Axis> axes(turns.size());
  for (std::size_t t = 0; t < turns.size(); ++t) axes[t] = turns[t].axis;
  return axes;
}

bool declares_home(const Campaign& campaign) {
  return campaign.declared_home_rad.size() == campaign.specified->joints();
}

}  // namespace

FittingOrders fitting_orders(const std::vector<Turn>& turns, std::size_t least, std::size_t most,
                             const Campaign& campaign) {
  const Arm& arm = *campaign.specified;
  const auto axes = axes_of(turns);
  const bool declared = declares_home(campaign);
  std::vector<Home> poses;
  if (declared) poses.emplace_back(campaign.declared_home_rad);
  if (!declared || campaign.declared_home_rad != arm.home_rad) poses.emplace_back(arm.home_rad);
  poses.emplace_back(std::nullopt);
  for (const Home& pose : poses) {
    JointOrders orders;
    for (std::size_t count = most; count >= least && orders.fitting.empty(); --count) {
      orders = orders_that_fit(axes, count, arm, pose);
      if (orders.undecided || count == 0) break;
    }
    if (orders.undecided) return {{}, true, false};
    if (!orders.fitting.empty())
      return {std::move(orders.fitting), false, declared && pose != campaign.declared_home_rad};
  }
  return {};
}

bool fit_at_home(const std::vector<Turn>& turns, const Campaign& campaign) {
  const Arm& arm = *campaign.specified;
  const auto& home = declares_home(campaign) ? campaign.declared_home_rad : arm.home_rad;
  return !orders_that_fit(axes_of(turns), turns.size(), arm, home).fitting.empty();
}

std::size_t turning_joints(const Arm& arm) {
  std::size_t count = 0;
  for (std::size_t j = 0; j < arm.joints(); ++j) count += arm.is_linear(j) ? 0U : 1U;
  return count;
}

}  // namespace identify
