#include "identify/chain/incident_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Eigenvalues>

namespace identify {

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

IncidentSearch::Sizes IncidentSearch::sizes_of(Incident::Kind kind) const {
  if (kind == Incident::Kind::move)
    return {smallest_mm_, most_move_mm(from_.fit.chain, nodes_.known), 4};
  return {4 * smallest_mm_, kMostStray_mm, 8};
}

// Beside all of the others, an incident has to be seen.
Incident IncidentSearch::sized(Incident incident, LinearisedChain& with) const {
  constexpr double kSeen = 4;
  const bool moves = incident.kind == Incident::Kind::move;
  const Sizes sizes = sizes_of(incident.kind);
  incident.deviance = std::numeric_limits<double>::infinity();
  for (const double less : kLessBeside) {
    ChainEffects effects = effects_.times(less);
    const double without = less < 1 ? incident.deviance : with.deviance(effects) - kSeen;
    double least = std::min(without, incident.deviance);
    double& size = moves ? effects.moved_mm : effects.stray_mm[incident.unit];
    std::optional<LinearisedChain::Left> left;  // whichever move there is
    for (int k = 0; sizes.at_mm(k) < sizes.most_mm; ++k) {
      size = sizes.at_mm(k);
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
    const Sizes sizes = sizes_of(one.kind);
    const bool mistaken =
        one.kind == Incident::Kind::stray && one.mm * sizes.factor > sizes.most_mm;
    return !(one.deviance < least + kNear) || !(one.mm > sizes.least_mm) || mistaken;
  });
  const auto observations = nodes_.observations;
  for (Incident& one : all) {
    nodes_.observations = observations;
    if (one.kind == Incident::Kind::move) nodes_.set_move(one.unit, one.part);
    Chain start = one.chain;
    if (!(one.effects.sag_rad > 0)) start.sags.clear();
    if (!(one.effects.steady_mm > 0)) start.drift_mm.setZero();
    ChainFit fit = fit_chain(start, nodes_, from_.noise, one.effects, false);
    if (fit.chain.sags.empty()) fit.chain.sags = one.chain.sags;
    one.chain = std::move(fit.chain);
    one.covariance = std::move(fit.covariance);
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
      found.push_back(
          sized({.kind = Incident::Kind::stray, .unit = unit, .chain = from_.fit.chain}, with));
  return fitted(std::move(found), here);
}

Incident IncidentSearch::move(std::size_t unit, double part) {
  Incident incident{
      .kind = Incident::Kind::move, .unit = unit, .part = part, .chain = from_.fit.chain};
  incident.chain.move.setZero(incident.chain.move_numbers());
  LinearisedChain with = linearised(incident);
  return sized(std::move(incident), with);
}

std::vector<Incident> IncidentSearch::moves(double here) {
  constexpr std::size_t kLooks = 80;
  const std::vector<std::size_t> units = nodes_.in_time();
  const std::size_t moments = 2 * units.size();  // a unit's begin and its middle
  std::vector<Incident> found;
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&](std::size_t moment) {
    found.push_back(move(units[moment / 2], moment % 2 == 0 ? 0 : 0.5));
    if (!(found.back().deviance < least)) return;
    least = found.back().deviance;
    best = moment;
  };
  // First in large steps, then on both sides of the best.
  std::size_t stride = std::max<std::size_t>(1, moments / kLooks);
  for (std::size_t moment = 1; moment < moments; moment += stride) look(moment);
  while (stride > 1) {
    stride = (stride + 1) / 2;
    const std::size_t middle = best;
    if (middle > stride) look(middle - stride);
    if (middle + stride < moments) look(middle + stride);
  }
  return fitted(std::move(found), here);
}

Incident IncidentSearch::at_its_moment(const Incident& found) {
  Incident best = move(found.unit, found.part);
  const std::vector<std::size_t> units = nodes_.in_time();
  const auto at = std::find(units.begin(), units.end(), found.unit);
  for (const std::size_t unit : {at == units.begin() ? *at : *std::prev(at), *at})
    for (const double part : {0.25, 0.5, 0.75}) {
      Incident other = move(unit, part);
      if (other.deviance < best.deviance) best = std::move(other);
    }
  nodes_.set_move(best.unit, best.part);
  return best;
}

namespace {

/// Which of its joint's sweeps a unit is.
ChainEstimate::SweepAt sweep_at(std::size_t unit, const ChainNodes& nodes) {
  const auto joint_of = [&](std::size_t u) {
    return nodes.strokes[nodes.units[u].front()].content.joint;
  };
  ChainEstimate::SweepAt at{joint_of(unit), 0, 0};
  for (const std::size_t other : nodes.in_time()) {
    if (joint_of(other) != at.joint) continue;
    if (other == unit) at.number = at.of;
    ++at.of;
  }
  return at;
}

/// What one covariance has beyond the other.
Eigen::MatrixXd beyond(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
  const Eigen::VectorXd sigma = one.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd scale =
      sigma.unaryExpr([](double x) { return x > 0 ? 1 / x : 0; });  // mm and rad alike
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(scale.asDiagonal() * (one - other) *
                                                             scale.asDiagonal());
  const Eigen::MatrixXd more = sigma.asDiagonal() * parts.eigenvectors();
  return more * parts.eigenvalues().cwiseMax(0).asDiagonal() * more.transpose();
}

}  // namespace

void compare_with(std::vector<Incident>& others, const ChainFit& taken, double deviance) {
  constexpr double kUnlikely = 0.01;
  for (Incident& one : others) one.weight = std::min(1.0, std::exp((deviance - one.deviance) / 2));
  std::erase_if(others, [&](const Incident& one) { return !(one.weight > kUnlikely); });
  const Chain& chain = taken.chain;
  const auto zeros = static_cast<Eigen::Index>(chain.zero_rad.size());
  const Eigen::Index count =
      ChainParameters{chain.axes.size(), chain.targets_mm.size()}.count(false);
  for (Incident& one : others) {
    one.change.resize(count + zeros);
    one.change.head(count) = change_between(chain, one.chain).head(count);
    for (std::size_t j = 0; j < chain.zero_rad.size(); ++j)
      one.change(count + static_cast<Eigen::Index>(j)) = one.chain.zero_rad[j] - chain.zero_rad[j];
    one.wider = beyond(one.covariance.topLeftCorner(count + zeros, count + zeros),
                       taken.covariance.topLeftCorner(count + zeros, count + zeros));
  }
}

Eigen::MatrixXd doubt_of(const std::vector<Incident>& others, Eigen::Index count) {
  Eigen::MatrixXd doubt = Eigen::MatrixXd::Zero(count, count);
  for (const Incident& one : others) {
    const Eigen::Index first = one.change.size();
    doubt.topLeftCorner(first, first) +=
        one.weight * (one.change * one.change.transpose() + one.wider);
  }
  return doubt;
}

std::vector<ChainEstimate::OtherExplanation> explanations(std::vector<Incident> others,
                                                          const ChainFit& fit,
                                                          const ChainNodes& nodes) {
  constexpr double kLikely = 0.1, kApart = 2;  // standard uncertainties
  std::erase_if(others, [&](const Incident& one) {
    const Eigen::ArrayXd variances =
        fit.covariance.diagonal().head(one.change.size()).array().max(0.0);
    return one.weight < kLikely ||
           !(one.change.array().square() > kApart * kApart * variances).any();
  });
  std::sort(others.begin(), others.end(),
            [](const Incident& a, const Incident& b) { return a.deviance < b.deviance; });
  std::vector<ChainEstimate::OtherExplanation> found;
  std::set<std::pair<Incident::Kind, std::size_t>> told;  // of moves at a unit the likeliest
  for (const Incident& one : others)
    if (told.insert({one.kind, one.unit}).second)
      found.push_back({sweep_at(one.unit, nodes), one.kind == Incident::Kind::move, one.mm});
  return found;
}

std::vector<ChainEstimate::StraySweep> strays_of(const ChainEffects& effects,
                                                 const ChainNodes& nodes) {
  std::vector<ChainEstimate::StraySweep> strays;
  if (effects.stray_mm.empty()) return strays;
  for (const std::size_t unit : nodes.in_time())
    if (effects.stray_mm[unit] > 0)
      strays.push_back({sweep_at(unit, nodes), effects.stray_mm[unit]});
  return strays;
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
