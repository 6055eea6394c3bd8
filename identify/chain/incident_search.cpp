#include "identify/chain/incident_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace identify {
namespace {

/// So much there may be of the other effects beside an incident.
constexpr std::array kLess{0.0, 1.0 / 4, 1.0};

ChainEffects less_of(ChainEffects effects, double times) {
  effects.home_rad *= times;
  effects.drift_mm *= times;
  effects.steady_mm *= times;
  for (double& figure_mm : effects.figures_mm) figure_mm *= times;
  return effects;
}

}  // namespace

IncidentSearch::IncidentSearch(ChainNodes& nodes, const FittedChain& from, ChainEffects effects,
                               ChainEffects shape)
    : nodes_(nodes),
      from_(from),
      effects_(std::move(effects)),
      shape_(std::move(shape)),
      smallest_mm_(smallest_mm(from, nodes)) {
  effects_.stray_mm.resize(nodes.units.size());
  shape_.stray_mm.resize(nodes.units.size());
}

// Beside all of the others, an incident has to be seen.
Incident IncidentSearch::sized(Incident incident, LinearisedChain& with) const {
  constexpr double kLargestStray_mm = 30, kSeen = 4;
  const bool moves = incident.kind == Incident::Kind::move;
  const double largest = moves ? kMostMove_mm : kLargestStray_mm, factor = moves ? 4 : 8;
  const double smallest = least_mm(incident.kind);
  incident.deviance = std::numeric_limits<double>::infinity();
  for (const double less : kLess) {
    ChainEffects effects = less_of(effects_, less);
    const double without = less < 1 ? incident.deviance : with.deviance(effects) - kSeen;
    double least = std::min(without, incident.deviance);
    double& size = moves ? effects.moved_mm : effects.stray_mm[incident.unit];
    std::optional<LinearisedChain::Left> left;  // whichever move there is
    for (size = smallest; size < largest; size *= factor) {
      if (!left || !moves) left = with.left_by(effects);
      const double deviance = with.deviance(*left, effects);
      if (!(deviance < least)) continue;
      least = incident.deviance = deviance;
      incident.mm = size;
      incident.effects = effects;
    }
  }
  return incident;
}

LinearisedChain IncidentSearch::linearised(const Incident& incident) {
  ChainEffects shape = shape_;
  if (incident.kind == Incident::Kind::move) {
    nodes_.set_move(incident.unit, incident.part);
    shape.moved_mm = 1;
  }
  return {incident.chain, nodes_, from_.noise, shape, false};
}

std::vector<Incident> IncidentSearch::fitted(std::vector<Incident> all, double here) {
  constexpr double kNear = 20;  // what is lost by not fitting
  double least = here;
  for (const Incident& one : all) least = std::min(least, one.deviance);
  std::erase_if(all, [&](const Incident& one) {
    return !(one.deviance < least + kNear) || !(one.mm > least_mm(one.kind));
  });
  const auto observations = nodes_.observations;
  for (Incident& one : all) {
    nodes_.observations = observations;
    if (one.kind == Incident::Kind::move) nodes_.set_move(one.unit, one.part);
    Chain start = one.chain;
    if (!(one.effects.sag_rad > 0)) start.sags.clear();
    if (!(one.effects.steady_mm > 0)) start.drift_mm.setZero();
    Chain chain = fit_chain(start, nodes_, from_.noise, one.effects, false).chain;
    if (chain.sags.empty()) chain.sags = one.chain.sags;
    one.chain = std::move(chain);
    LinearisedChain with = linearised(one);
    one = sized(std::move(one), with);
  }
  nodes_.observations = observations;
  return all;
}

std::vector<Incident> IncidentSearch::strays(double here) {
  std::vector<Incident> found;
  LinearisedChain with(from_.fit.chain, nodes_, from_.noise, shape_, false);
  for (std::size_t unit = 0; unit < nodes_.units.size(); ++unit)
    if (!(shape_.stray_mm[unit] > 0))
      found.push_back(sized({Incident::Kind::stray, unit, 0, 0, {}, from_.fit.chain, 0}, with));
  return fitted(std::move(found), here);
}

Incident IncidentSearch::move(std::size_t unit, double part) {
  Incident incident{Incident::Kind::move, unit, part, 0, {}, from_.fit.chain, 0};
  incident.chain.move.setZero(incident.chain.move_numbers());
  LinearisedChain with = linearised(incident);
  return sized(std::move(incident), with);
}

std::vector<Incident> IncidentSearch::moves(double here) {
  constexpr std::size_t kLooks = 40;
  const std::vector<std::size_t> units = nodes_.in_time();
  std::vector<Incident> found;
  std::size_t best = 0;  // in time's order
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&](std::size_t at) {
    found.push_back(move(units[at], 0));
    if (!(found.back().deviance < least)) return;
    least = found.back().deviance;
    best = at;
  };
  // First in large steps, then on both sides of the best.
  std::size_t stride = std::max<std::size_t>(1, units.size() / kLooks);
  for (std::size_t at = 1; at < units.size(); at += stride) look(at);
  while (stride > 1) {
    stride = (stride + 1) / 2;
    const std::size_t middle = best;
    if (middle > stride) look(middle - stride);
    if (middle + stride < units.size()) look(middle + stride);
  }
  return fitted(std::move(found), here);
}

Incident IncidentSearch::at_its_moment(const Incident& found) {
  Incident best = move(found.unit, found.part);
  const std::vector<std::size_t> units = nodes_.in_time();
  const auto at = std::find(units.begin(), units.end(), found.unit);
  for (const std::size_t unit : {*std::prev(at), *at})
    for (const double part : {0.25, 0.5, 0.75}) {
      Incident other = move(unit, part);
      if (other.deviance < best.deviance) best = std::move(other);
    }
  nodes_.set_move(best.unit, best.part);
  return best;
}

double smallest_mm(const FittedChain& fitted, const ChainNodes& nodes) {
  double weight = 0, strokes = 0;
  for (const StrokeMoments& stroke : nodes.strokes) {
    weight += stroke.weight / stroke.correlation;
    strokes += static_cast<double>(stroke.strokes);
  }
  return fitted.noise.position_mm / std::sqrt(weight / strokes);
}

}  // namespace identify
