#include "identify/chain/chain_sag.hpp"

#include <cmath>
#include <optional>

namespace identify {
namespace {

using Eigen::Vector3d;

/// Where loads hang, and about what they pull.
struct Loads {
  Vector3d up = Vector3d::Zero();
  std::vector<Vector3d> directions;
  std::vector<Vector3d> points;  // of the axes, then the first target
};

std::optional<std::size_t> first_turning(const Chain& chain) {
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    if (!chain.axes[j].linear) return j;
  return std::nullopt;
}

Loads loads_at(const Chain& chain, const Turns& turns) {
  Loads loads;
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < chain.axes.size(); ++j) {
    loads.directions.emplace_back(moved.linear() * chain.axes[j].direction);
    loads.points.emplace_back(moved * chain.axes[j].point_mm);
    if (turns[j] != 0) moved = moved * chain.axes[j].displacement(turns[j]);
  }
  loads.points.emplace_back(moved * chain.targets_mm.front());
  if (const auto first = first_turning(chain)) loads.up = loads.directions[*first];
  return loads;
}

double lever(const ChainSag& sag, const Loads& loads) {
  const Vector3d arm = loads.points[sag.load] - loads.points[sag.joint];
  return loads.up.dot(loads.directions[sag.joint].cross(arm)) / sag.reach_mm;
}

}  // namespace

std::vector<ChainSag> sags_of(const Chain& chain, const std::vector<bool>& known,
                              const std::vector<double>& sag_rad) {
  std::vector<ChainSag> sags;
  const auto upright = first_turning(chain);
  if (sag_rad.empty() || !upright || !known[*upright]) return sags;
  const Loads home = loads_at(chain, {});
  for (std::size_t j = 0; j < chain.axes.size(); ++j) {
    if (!known[j] || chain.axes[j].linear || !(sag_rad[j] > 0)) continue;
    const std::size_t first = sags.size();
    double reach = 0;  // stretched out
    std::size_t before = j;
    for (std::size_t load = j + 1; load < home.points.size(); ++load) {
      if (load < known.size() && (!known[load] || chain.axes[load].linear)) continue;
      reach += (home.points[load] - home.points[before]).norm();
      before = load;
      if (reach > 0) sags.push_back({j, load, reach, 0, 0});
    }
    for (std::size_t s = first; s < sags.size(); ++s)
      sags[s].sigma_rad = sag_rad[j] / std::sqrt(static_cast<double>(sags.size() - first));
  }
  return sags;
}

std::vector<double> sag_levers(const Chain& chain, const Turns& turns) {
  std::vector<double> levers;
  if (chain.sags.empty()) return levers;
  const Loads here = loads_at(chain, turns), home = loads_at(chain, {});
  for (const ChainSag& sag : chain.sags) levers.push_back(lever(sag, here) - lever(sag, home));
  return levers;
}

Turns sagged(const Chain& chain, const Turns& turns) {
  Turns bent = turns;
  const auto levers = sag_levers(chain, turns);
  for (std::size_t s = 0; s < levers.size(); ++s)
    bent[chain.sags[s].joint] += chain.sags[s].rad * levers[s];
  return bent;
}

}  // namespace identify
