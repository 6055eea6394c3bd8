#include "identify/chain/along_search.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

/// From the middle of a stroke to its end. Less is a creep like others.
constexpr std::array kSizes_deg{0.01, 0.04, 0.16, 0.64, 2.56};
/// What is that much likelier is not the one for sure.
constexpr double kAboutAsLikely = 6;

}  // namespace

std::vector<ChainEffects::Along> likeliest_along(const FittedChain& from, ChainNodes& nodes,
                                                 const ChainEffects& effects,
                                                 const ChainEffects& shape, double here) {
  ChainEffects with_one = shape;
  with_one.along.emplace_back();
  LinearisedChain with(from.fit.chain, nodes, from.noise, with_one, false);
  struct Pair {
    ChainEffects beside;  // and it
    double deviance = std::numeric_limits<double>::infinity();
    [[nodiscard]] const ChainEffects::Along& along() const { return beside.along.back(); }
  };
  const auto look = [&](Pair& pair, const ChainEffects& tried) {
    const double deviance = with.deviance(tried);
    if (deviance < pair.deviance) pair = {tried, deviance};
  };
  std::vector<Pair> pairs;
  const std::size_t joints = nodes.known.size();
  for (std::size_t swept = 0; swept < joints; ++swept)
    for (std::size_t joint = 0; joint < joints; ++joint) {
      if (swept == joint || !nodes.known[swept] || !nodes.known[joint]) continue;
      Pair& pair = pairs.emplace_back();
      for (const double less : kLessBeside) {
        ChainEffects tried = effects.times(less);
        tried.stray_mm = shape.stray_mm;
        tried.along = with_one.along;
        for (const double deg : kSizes_deg) {
          const double rad = deg * kDegree;
          tried.along.back() = {swept, joint, rad, rad};
          look(pair, tried);
          // Something that stood elsewhere meanwhile has to explain less.
          tried.along.back().rad = 0;
          here = std::min(here, with.deviance(tried));
        }
      }
    }
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& one, const Pair& other) { return one.deviance < other.deviance; });
  std::vector<ChainEffects::Along> found;
  if (pairs.empty() || !(pairs.front().deviance < here - kWentAlong)) return found;
  for (Pair& pair : pairs) {
    if (!(pair.deviance < pairs.front().deviance + kAboutAsLikely) ||
        pair.along().swept != pairs.front().along().swept)
      continue;
    const double rad = pair.along().rad;
    for (const double between : {rad / 2, rad * 2}) {
      ChainEffects tried = pair.beside;
      tried.along.back().rad = tried.along.back().off_rad = between;
      look(pair, tried);
    }
    found.push_back(pair.along());
  }
  return found;
}

}  // namespace identify
