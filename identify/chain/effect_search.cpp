#include "identify/chain/effect_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/chain/chain_sag.hpp"
#include "identify/chain/effect_sizes.hpp"
#include "identify/chain/linearised_chain.hpp"
#include "identify/chain/uneven_joints.hpp"

namespace identify {
namespace {

/// By so much less the deviance has to be of a device that sways than of one that walks at random:
/// of walks, too, some seem to sway.
constexpr double kSways = 20;

}  // namespace

void EffectSearch::find_all(FittedChain& best) {
  const std::size_t joints = best.fit.chain.axes.size();
  const bool several_homes = nodes_.homes.size() > 1;
  best.fit.chain.sags = sags_of(best.fit.chain, nodes_.known, sag_rad_);
  effects_.sag_told = !best.fit.chain.sags.empty();
  for (const ChainSag& sag : best.fit.chain.sags)
    effects_.sag_rad = std::max(effects_.sag_rad, sag_rad_[sag.joint]);
  ChainEffects shape = effects_;
  if (several_homes && !effects_.sag_told) {
    best.fit.chain.sags = sags_of(best.fit.chain, nodes_.known, std::vector<double>(joints, 1.0));
    shape.sag_rad = best.fit.chain.sags.empty() ? 0 : 1;
  }
  shape.figures_mm.fill(1);
  shape.home_rad = shape.drift_mm = nodes_.units.size() > 1 ? 1 : 0;  // from stroke to stroke
  shape.steady_mm = nodes_.timed ? 1 : 0;
  shape.offset_rad = several_homes ? 1 : 0;
  const FittedChain first = best;
  size_twice(best, shape);
  if (nodes_.stays() && shows_any(best)) {
    // Whether joints that stood still stood elsewhere in each stroke, the likelihood tells. What is
    // the same there and back may have been taken for the arc's figure.
    ChainEffects other = shape;
    other.home_stays = true;
    if (take_if_likelier(best, first, other, 0)) shape = other;
  }
  if (nodes_.timed) {
    shape.drift_parts = kDriftParts;
    FittedChain from = best;
    from.fit.chain.sags = first.fit.chain.sags;  // they may have been taken for a walk
    if (may_sway(from, shape)) take_if_likelier(best, from, shape, kSways);
  }
}

bool EffectSearch::shows_any(const FittedChain& best) {
  constexpr double kShown = 4;
  LinearisedChain linearised(best.fit.chain, nodes_, best.noise, effects_, false);
  ChainEffects none = effects_;
  none.home_rad = none.drift_mm = none.sag_rad = none.steady_mm = 0;
  none.figures_mm = {};
  return linearised.deviance(none) > linearised.deviance(effects_) + kShown;
}

// In place of the walk and of homes that are off, or beside less of them.
bool EffectSearch::may_sway(const FittedChain& best, const ChainEffects& shape) {
  LinearisedChain with(best.fit.chain, nodes_, best.noise, shape, false);
  const double here = with.deviance(effects_);
  const double reach = reach_mm(best.fit.chain, nodes_.known);
  const double scatter_mm = std::hypot(effects_.drift_mm, effects_.home_rad * reach);
  for (const double less : {0.0, 1.0 / 16, 1.0 / 4, 1.0}) {
    ChainEffects effects = effects_;
    effects.drift_mm *= less;
    effects.home_rad *= less;
    const auto left = with.left_by(effects);
    for (const double steady : {1.0 / 4, 1.0, 4.0, 16.0})
      if (with.deviance(left, effects.sag_rad, steady * scatter_mm) < here - kSways / 2)
        return true;
  }
  return false;
}

bool EffectSearch::take_if_likelier(FittedChain& best, FittedChain from, const ChainEffects& shape,
                                    double by) {
  const auto deviance = [&](const FittedChain& fitted) {
    return LinearisedChain(fitted.fit.chain, nodes_, fitted.noise, effects_, false)
        .deviance(effects_);
  };
  const double here = deviance(best);
  const auto nodes = nodes_.observations;
  const ChainEffects effects = effects_;
  size_twice(from, shape);
  if (deviance(from) < here - by) {
    best = std::move(from);
    return true;
  }
  nodes_.observations = nodes;
  effects_ = effects;
  return false;
}

void EffectSearch::size_twice(FittedChain& best, ChainEffects shape) {
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    size(best, shape);
    shape.home_times = effects_.home_times;
    shape.figure_times = effects_.figure_times;
  }
}

void EffectSearch::size(FittedChain& best, const ChainEffects& shape) {
  double weight = 0, strokes = 0;
  for (const StrokeMoments& stroke : nodes_.strokes) {
    weight += stroke.weight / stroke.correlation;
    strokes += static_cast<double>(stroke.strokes);
  }
  Chain& chain = best.fit.chain;
  LinearisedChain linearised(chain, nodes_, best.noise, shape, false);
  effects_ = effect_sizes(linearised, shape, best.noise.position_mm / std::sqrt(weight / strokes),
                          reach_mm(chain, nodes_.known));
  find_uneven_joints(linearised, chain.axes.size(), effects_);
  // A joint whose sag may be anything could not be told from its angle, and one of none has no sag.
  if (!(effects_.sag_rad > 0)) chain.sags.clear();
  if (!(effects_.steady_mm > 0)) chain.drift_mm.setZero();
  best.fit = fit_chain(chain, nodes_, best.noise, effects_, false);
}

double reach_mm(const Chain& chain, const std::vector<bool>& known) {
  double reach = 1;
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    for (const Eigen::Vector3d& target : chain.targets_mm)
      if (known[j])
        reach = std::max(reach,
                         (target - chain.axes[j].point_mm).cross(chain.axes[j].direction).norm());
  return reach;
}

}  // namespace identify
