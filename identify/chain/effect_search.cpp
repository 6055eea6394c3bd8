#include "identify/chain/effect_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "identify/chain/along_search.hpp"
#include "identify/chain/chain_sag.hpp"
#include "identify/chain/effect_sizes.hpp"
#include "identify/chain/linearised_chain.hpp"
#include "identify/chain/uneven_joints.hpp"

namespace identify {
namespace {

/// By so much less the deviance has to be of a device that sways than of one that walks at random:
/// of walks, too, some seem to sway.
constexpr double kSways = 20;
/// Of joints that stand elsewhere in each stroke some seem to rest, and more is known if they do.
constexpr double kRests = 4;
/// And of what happened once. With less, it is one explanation among others.
constexpr double kHappened = 20;
/// That much likelier is not the one for sure.
constexpr double kAlike = 6;

const Incident* likeliest(const std::vector<Incident>& all) {
  const auto one = std::min_element(
      all.begin(), all.end(),
      [](const Incident& a, const Incident& b) { return a.deviance < b.deviance; });
  return one == all.end() ? nullptr : &*one;
}

/// Off home, a linear joint moves the target by about as much as one that turns does at its reach.
std::vector<double> usual_home_times(const Chain& chain, double reach_mm) {
  std::vector<double> times;
  for (const ChainAxis& axis : chain.axes)
    times.push_back(axis.linear ? std::max(1.0, reach_mm / kLinear_mm) : 1);
  return times;
}

}  // namespace

std::vector<Incident> EffectSearch::find_all(FittedChain& best) {
  happened_ = kHappened;
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
  std::vector<Incident> others;
  if (shows_any(best, effects_)) {
    find_lasting(best, first, shape);
    find_creep(best, first, shape);
    const ChainEffects without = shape;
    others = find_strays(best, first, shape);
    for (ChainEffects along = without; find_along(best, first, along, others); shape = along)
      others = find_strays(best, first, along);
  }
  if (nodes_.timed) {
    FittedChain from = best;
    from.fit.chain.sags = first.fit.chain.sags;  // they may have been taken for a walk
    const ChainEffects effects = effects_;
    ChainEffects waves = shape;
    waves.drift_parts = kDriftParts;
    if (may_sway(from, waves)) take_if_likelier(best, from, waves, kSways);
    if (const Incident* one = likeliest(others); one && one->kind == Incident::Kind::move)
      find_move(best, {first, effects, shape}, *one);
  }
  compare_with(others, best.fit, deviance_of(best));
  return others;
}

std::vector<Incident> EffectSearch::find_strays(FittedChain& best, const FittedChain& first,
                                                ChainEffects& shape) {
  constexpr int kMostStrays = 3;
  std::vector<Incident> others;
  for (int round = 0;; ++round) {
    const double here = deviance_of(best);
    IncidentSearch search(nodes_, first, effects_, shape);
    std::vector<Incident> all = search.strays(here);
    if (nodes_.timed)
      for (Incident& move : search.moves(here)) all.push_back(std::move(move));
    const Incident* one = likeliest(all);
    if (round == kMostStrays || !one || one->kind == Incident::Kind::move ||
        !(one->deviance < here - happened_))
      return all;
    ChainEffects other = shape;
    other.stray_mm.resize(nodes_.units.size());
    for (const Incident& stray : all)
      if (stray.kind == one->kind && stray.deviance < one->deviance + kAlike)
        other.stray_mm[stray.unit] = stray.mm;
    if (!take_if_likelier(best, first, other, 0)) return all;
    shape = other;
  }
}

void EffectSearch::find_move(FittedChain& best, IncidentsFrom from, const Incident& move) {
  if (!(move.deviance < deviance_of(best) - happened_)) return;
  IncidentSearch search(nodes_, from.first, from.effects, from.shape);
  from.shape.moved_mm = search.at_its_moment(move).mm;
  from.first.fit.chain.move.setZero(from.first.fit.chain.move_numbers());
  take_if_likelier(best, std::move(from.first), from.shape, happened_);
}

bool EffectSearch::shows_any(const FittedChain& fitted, const ChainEffects& effects) {
  constexpr double kShown = 4;
  LinearisedChain linearised(fitted.fit.chain, nodes_, fitted.noise, effects, false);
  ChainEffects none = effects;
  none.home_rad = none.creep_rad = none.drift_mm = none.sag_rad = none.steady_mm = 0;
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

void EffectSearch::find_lasting(FittedChain& best, const FittedChain& first, ChainEffects& shape) {
  const auto take_lasting = [&](HomeLasts lasts, double by) {
    ChainEffects other = shape;
    other.home_lasts = lasts;
    if (!take_if_likelier(best, first, other, by)) return false;
    shape = other;
    return true;
  };
  if (nodes_.stays()) take_lasting(HomeLasts::stand, 0);
  if (nodes_.most_rests() == 0) return;
  // Rests may be in place of what happened once, which has to be so much likelier than joints that
  // do not rest, and clearly likelier than those that do.
  const double before = deviance_of(best);
  if (take_lasting(HomeLasts::rest, kRests))
    happened_ = std::max(kAlike, kHappened - (before - deviance_of(best)));
}

void EffectSearch::find_creep(FittedChain& best, const FittedChain& first, ChainEffects& shape) {
  ChainEffects creeping = shape;
  creeping.creep_rad = 1;
  if (!may_creep(best, creeping)) return;
  const double before = deviance_of(best);
  take(best, tried(first, creeping));
  creeping.creep_gain = effects_.creep_gain = before - deviance_of(best);
  shape = creeping;
}

bool EffectSearch::find_along(FittedChain& best, const FittedChain& first, ChainEffects& shape,
                              const std::vector<Incident>& others) {
  const Incident* other = likeliest(others);
  const double here = other ? std::min(deviance_of(best), other->deviance) : deviance_of(best);
  const auto found = likeliest_along(first, nodes_, effects_, shape, here);
  if (found.empty()) return false;
  shape.along.insert(shape.along.end(), found.begin(), found.end());
  return take_if_likelier(best, first, shape, kWentAlong);
}

// Beside what else there is, or in place of it.
bool EffectSearch::may_creep(const FittedChain& best, const ChainEffects& shape) {
  if (!nodes_.sweeps_again()) return false;
  LinearisedChain with(best.fit.chain, nodes_, best.noise, shape, false);
  const double here = with.deviance(effects_);
  const double reach = reach_mm(best.fit.chain, nodes_.known);
  for (const double less : kLessBeside) {
    ChainEffects effects = effects_;
    effects.drift_mm *= less;
    effects.home_rad *= less;
    double mm = smallest_mm(best, nodes_);
    while (mm < kMostStray_mm) {
      effects.creep_rad = mm / reach;
      if (with.deviance(effects) < here) return true;
      mm *= 4;
    }
  }
  return false;
}

double EffectSearch::deviance_of(const FittedChain& fitted, const ChainEffects& effects) {
  return LinearisedChain(fitted.fit.chain, nodes_, fitted.noise, effects, false).deviance(effects);
}

EffectSearch::Tried EffectSearch::tried(FittedChain from, const ChainEffects& shape) {
  const auto observations = nodes_.observations;
  const ChainEffects effects = effects_;
  size_twice(from, shape);
  const auto move = move_of(from.fit, nodes_);
  const bool mistaken = move && move->mm.norm() > most_move_mm(from.fit.chain, nodes_.known);
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
  effects_ = effect_sizes(linearised, shape, smallest_mm(best, nodes_), reach);
  find_uneven_joints(linearised, usual_home_times(chain, reach), effects_);
  // A joint whose sag may be anything could not be told from its angle, and one of none has no sag.
  if (!(effects_.sag_rad > 0)) chain.sags.clear();
  if (!(effects_.steady_mm > 0)) chain.drift_mm.setZero();
  if (!(effects_.moved_mm > 0)) chain.move.resize(0);
  best.fit = fit_chain(chain, nodes_, best.noise, effects_, false);
}

}  // namespace identify
