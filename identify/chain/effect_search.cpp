#include "identify/chain/effect_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "identify/chain/chain_sag.hpp"
#include "identify/chain/effect_sizes.hpp"
#include "identify/chain/linearised_chain.hpp"
#include "identify/chain/uneven_joints.hpp"

namespace identify {
namespace {

/// By so much less the deviance has to be of a device that sways than of one that walks at random:
/// of walks, too, some seem to sway.
constexpr double kSways = 20;
/// And of one that was moved.
constexpr double kMoves = 12;
/// And of one stroke that is unlike the others.
constexpr double kDisturbed = 20;
/// A larger move is a mistake, and none of the effects.
constexpr double kMostMove_mm = 0.5;

ChainEffects less_of(ChainEffects effects, double times) {
  effects.home_rad *= times;
  effects.drift_mm *= times;
  effects.steady_mm *= times;
  for (double& figure_mm : effects.figures_mm) figure_mm *= times;
  return effects;
}

/// Off home, a linear joint moves the target by about as much as one that turns does at its reach.
std::vector<double> usual_home_times(const Chain& chain, double reach_mm) {
  std::vector<double> times;
  for (const ChainAxis& axis : chain.axes)
    times.push_back(axis.linear ? std::max(1.0, reach_mm / kLinear_mm) : 1);
  return times;
}

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
  shape.home_times = usual_home_times(best.fit.chain, reach_mm(best.fit.chain, nodes_.known));
  const FittedChain first = best;
  size_twice(best, shape);
  if (nodes_.stays() && shows_any(best, effects_)) {
    // Whether joints that stood still stood elsewhere in each stroke, the likelihood tells. What is
    // the same there and back may have been taken for the arc's figure.
    ChainEffects other = shape;
    other.home_stays = true;
    if (take_if_likelier(best, first, other, 0)) shape = other;
  }
  if (shows_any(best, effects_)) find_strays(best, first, shape);
  if (nodes_.timed) {
    FittedChain from = best;
    from.fit.chain.sags = first.fit.chain.sags;  // they may have been taken for a walk
    const ChainEffects effects = effects_;
    ChainEffects waves = shape;
    waves.drift_parts = kDriftParts;
    if (may_sway(from, waves)) take_if_likelier(best, from, waves, kSways);
    if (!shows_any(from, effects)) return;
    from.fit.chain.move.setZero(from.fit.chain.move_numbers());
    if (const auto moved_mm = likeliest_move_mm(from, effects, shape, kMoves)) {
      shape.moved_mm = *moved_mm;
      take_if_likelier(best, from, shape, kMoves);
    }
  }
}

std::optional<double> EffectSearch::likeliest_move_mm(const FittedChain& fitted,
                                                      const ChainEffects& effects,
                                                      ChainEffects shape, double by) {
  const std::vector<std::size_t> units = nodes_.in_time();
  const double smallest = smallest_mm(fitted);
  shape.moved_mm = 1;
  double least = std::numeric_limits<double>::infinity(), without = least, moved_mm = 0;
  struct Moment {
    std::size_t unit = 0;  // in time's order
    double part = 0;
  } best;
  const auto look = [&](std::size_t unit, double part) {
    nodes_.set_move(units[unit], part);
    LinearisedChain with(fitted.fit.chain, nodes_, fitted.noise, shape, false);
    for (const double less : {0.0, 1.0 / 4, 1.0}) {
      ChainEffects here = less_of(effects, less);
      const auto left = with.left_by(here);
      if (less == 1) without = with.deviance(left, here);
      for (here.moved_mm = smallest; here.moved_mm < kMostMove_mm; here.moved_mm *= 4) {
        const double deviance = with.deviance(left, here);
        if (!(deviance < least)) continue;
        least = deviance;
        moved_mm = here.moved_mm;
        best = {unit, part};
      }
    }
  };
  // First in large steps, then on both sides of the best.
  constexpr std::size_t kLooks = 40;
  std::size_t stride = std::max<std::size_t>(1, units.size() / kLooks);
  for (std::size_t unit = 1; unit < units.size(); unit += stride) look(unit, 0);
  while (stride > 1) {
    stride = (stride + 1) / 2;
    const std::size_t middle = best.unit;
    if (middle > stride) look(middle - stride, 0);
    if (middle + stride < units.size()) look(middle + stride, 0);
  }
  if (!(least < without - by)) return std::nullopt;
  const std::size_t after = best.unit;
  for (const std::size_t unit : {after - 1, after})
    for (const double part : {0.25, 0.5, 0.75}) look(unit, part);
  nodes_.set_move(units[best.unit], best.part);
  return moved_mm;
}

void EffectSearch::find_strays(FittedChain& best, const FittedChain& first, ChainEffects& shape) {
  constexpr int kMostStrays = 3;
  constexpr double kAlike = 6;  // that much likelier is not the one for sure
  const auto add = [&](const Stray& one, ChainEffects& to) {
    to.stray_mm.resize(nodes_.units.size());
    to.stray_mm[one.unit] = one.mm;
  };
  for (int round = 0; round < kMostStrays; ++round) {
    const double here = deviance_of(best);
    std::vector<std::pair<Stray, Tried>> all;
    double least = std::numeric_limits<double>::infinity();
    for (const Stray& one : likeliest_strays(best, first, shape)) {
      ChainEffects other = shape;
      add(one, other);
      all.emplace_back(one, tried(first, other));
      least = std::min(least, all.back().second.deviance);
    }
    if (!(least < here - kDisturbed)) return;
    std::erase_if(all, [&](const auto& one) { return one.second.deviance >= least + kAlike; });
    ChainEffects together = shape;
    for (const auto& [one, alone] : all) add(one, together);
    Tried found = all.size() == 1 ? std::move(all.front().second) : tried(first, together);
    if (!(found.deviance < here)) return;
    take(best, std::move(found));
    shape = together;
  }
}

// By the strokes' own likelihoods. Where the fit knows of effects, nothing shows unless a stroke is
// unlike the others; but it may have taken up what is told best without them. Of the few that are
// left the likelihood of all is asked, as far as that takes no fit.
std::vector<EffectSearch::Stray> EffectSearch::likeliest_strays(const FittedChain& best,
                                                                const FittedChain& first,
                                                                const ChainEffects& shape) {
  constexpr double kAny = 3;
  constexpr std::size_t kMost = 4;
  const auto gains = gains_of_strays(best, shape);
  if (std::none_of(gains.begin(), gains.end(), [](const Stray& one) { return one.gain > kAny; }))
    return {};
  auto found = gains_of_strays(first, shape);
  std::sort(found.begin(), found.end(),
            [](const Stray& a, const Stray& b) { return a.gain > b.gain; });
  found.resize(std::min(found.size(), kMost));
  const double least_gain = found.front().gain / 4;
  std::erase_if(found, [&](const Stray& one) { return !(one.gain > least_gain); });
  LinearisedChain with(first.fit.chain, nodes_, first.noise, shape, false);
  const double here = with.deviance(effects_);
  std::erase_if(found, [&](const Stray& one) {
    double least = here;
    for (const double less : {0.0, 1.0 / 4, 1.0}) {
      ChainEffects effects = less_of(effects_, less);
      effects.stray_mm.resize(nodes_.units.size());
      effects.stray_mm[one.unit] = one.mm;
      least = std::min(least, with.deviance(effects));
    }
    return !(least < here - kDisturbed);
  });
  return found;
}

std::vector<EffectSearch::Stray> EffectSearch::gains_of_strays(const FittedChain& fitted,
                                                               const ChainEffects& shape) {
  constexpr double kLargest_mm = 30;
  ChainEffects known = effects_, alone = shape;
  known.home_stays = alone.home_stays = false;  // what strokes share is each one's, too
  LinearisedChain with(fitted.fit.chain, nodes_, fitted.noise, alone, false);
  const double smallest = 4 * smallest_mm(fitted);
  const auto all_of = [](const std::vector<double>& ones) {
    return std::accumulate(ones.begin(), ones.end(), 0.0);
  };
  const double here = all_of(with.own_deviances(known));
  std::vector<Stray> strays(nodes_.units.size());
  for (const double less : {0.0, 1.0 / 16, 1.0 / 4, 1.0}) {
    ChainEffects effects = less_of(known, less);
    const std::vector<double> without = with.own_deviances(effects);
    const double others = here - all_of(without);
    double stray_mm = smallest;
    while (stray_mm < kLargest_mm) {
      effects.stray_mm.assign(strays.size(), stray_mm);
      const std::vector<double> own = with.own_deviances(effects);
      for (std::size_t u = 0; u < strays.size(); ++u) {
        const double gain = others + without[u] - own[u];
        const bool found = !known.stray_mm.empty() && known.stray_mm[u] > 0;
        if (!found && gain > strays[u].gain) strays[u] = {u, stray_mm, gain};
      }
      stray_mm *= 4;
    }
  }
  return strays;
}

bool EffectSearch::shows_any(const FittedChain& fitted, const ChainEffects& effects) {
  constexpr double kShown = 4;
  LinearisedChain linearised(fitted.fit.chain, nodes_, fitted.noise, effects, false);
  ChainEffects none = effects;
  none.home_rad = none.drift_mm = none.sag_rad = none.steady_mm = 0;
  none.figures_mm = {};
  return linearised.deviance(none) > linearised.deviance(effects) + kShown;
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
    for (const double steady : {1.0 / 4, 1.0, 4.0, 16.0}) {
      effects.steady_mm = steady * scatter_mm;
      if (with.deviance(left, effects) < here - kSways / 2) return true;
    }
  }
  return false;
}

double EffectSearch::deviance_of(const FittedChain& fitted) {
  return LinearisedChain(fitted.fit.chain, nodes_, fitted.noise, effects_, false)
      .deviance(effects_);
}

EffectSearch::Tried EffectSearch::tried(FittedChain from, const ChainEffects& shape) {
  const auto observations = nodes_.observations;
  const ChainEffects effects = effects_;
  size_twice(from, shape);
  const auto move = move_of(from.fit, nodes_);
  const bool mistaken = move && move->mm.norm() > kMostMove_mm;
  const double deviance = mistaken ? std::numeric_limits<double>::infinity() : deviance_of(from);
  return {std::move(from), std::exchange(effects_, effects),
          std::exchange(nodes_.observations, observations), deviance};
}

void EffectSearch::take(FittedChain& best, Tried other) {
  best = std::move(other.fitted);
  effects_ = std::move(other.effects);
  nodes_.observations = std::move(other.observations);
}

bool EffectSearch::take_if_likelier(FittedChain& best, FittedChain from, const ChainEffects& shape,
                                    double by) {
  const double here = deviance_of(best);
  Tried other = tried(std::move(from), shape);
  if (!(other.deviance < here - by)) return false;
  take(best, std::move(other));
  return true;
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
  Chain& chain = best.fit.chain;
  LinearisedChain linearised(chain, nodes_, best.noise, shape, false);
  const double reach = reach_mm(chain, nodes_.known);
  effects_ = effect_sizes(linearised, shape, smallest_mm(best), reach);
  find_uneven_joints(linearised, usual_home_times(chain, reach), effects_);
  // A joint whose sag may be anything could not be told from its angle, and one of none has no sag.
  if (!(effects_.sag_rad > 0)) chain.sags.clear();
  if (!(effects_.steady_mm > 0)) chain.drift_mm.setZero();
  if (!(effects_.moved_mm > 0)) chain.move.resize(0);
  best.fit = fit_chain(chain, nodes_, best.noise, effects_, false);
}

double EffectSearch::smallest_mm(const FittedChain& fitted) const {
  double weight = 0, strokes = 0;
  for (const StrokeMoments& stroke : nodes_.strokes) {
    weight += stroke.weight / stroke.correlation;
    strokes += static_cast<double>(stroke.strokes);
  }
  return fitted.noise.position_mm / std::sqrt(weight / strokes);
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
