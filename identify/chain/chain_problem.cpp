#include "identify/chain/chain_problem.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace identify {
namespace {

/// Along an arc on which the joint's angle is free nothing tells where a target is, and what is
/// left there of its equations is rounding.
void leave_out_rounding(const ChainParameters& parameters, NormalEquations& equations) {
  constexpr double kRounding = 1e-12;
  for (std::size_t t = 0; t < parameters.targets; ++t) {
    const Eigen::Index from = parameters.target(t);
    const double most = equations.normal.diagonal().segment<3>(from).maxCoeff();
    for (Eigen::Index k = from; k < from + 3; ++k) {
      if (!(equations.normal(k, k) < kRounding * most)) continue;
      equations.normal.row(k).setZero();
      equations.normal.col(k).setZero();
      equations.gradient(k) = 0;
    }
  }
}

}  // namespace

template <int Size>
ChainProblem<Size>::ChainProblem(const Chain& chain, ChainNodes& nodes, const ChainNoise& noise,
                                 const ChainEffects& shape)
    : nodes_(nodes),
      noise_(noise),
      shape_(shape),
      columns_(shape, nodes),
      variances_(variances_of(shape, nodes, columns_)),
      weights_(nodes.observations.size()),
      swept_(nodes.observations.size()),
      ranges_(nodes.home_of.size()) {
  ChainPose pose(chain);
  for (std::size_t i = 0; i < nodes_.observations.size(); ++i) {
    const ChainObservation& seen = nodes_.observations[i];
    pose.set(seen.target, turns_of(chain, seen, noise), false);
    weights_[i] = ChainResidual<Size>::base_weight(chain, seen, noise, pose);
    swept_[i] = seen.turns[seen.joint];
  }
  for (std::size_t u = 0; u < nodes.units.size(); ++u)
    for (const std::size_t s : nodes.units[u])
      for (std::size_t n = 0; n < nodes.strokes[s].nodes.size(); ++n) {
        Range& range = ranges_[nodes.group[u]];
        range.from = std::min(range.from, swept_[nodes.first[s] + n]);
        range.to = std::max(range.to, swept_[nodes.first[s] + n]);
      }
}

template <int Size>
Eigen::Index ChainProblem<Size>::count(const Chain& chain) {
  return ChainParameters{chain.axes.size(), chain.targets_mm.size()}.count(Size == 6);
}

template <int Size>
Eigen::Index ChainProblem<Size>::count_all(const Chain& chain) const {
  return first_move(chain) + (shape_.moved_mm > 0 ? chain.move_numbers() : 0);
}

template <int Size>
Eigen::Index ChainProblem<Size>::first_sag(const Chain& chain) const {
  return count(chain) + static_cast<Eigen::Index>(shape_.zero_rad.size());
}

template <int Size>
Eigen::Index ChainProblem<Size>::first_drift(const Chain& chain) const {
  return first_sag(chain) + static_cast<Eigen::Index>(chain.sags.size());
}

template <int Size>
Eigen::Index ChainProblem<Size>::first_move(const Chain& chain) const {
  return first_drift(chain) + shape_.drift_columns();
}

template <int Size>
void ChainProblem<Size>::follow() {
  for (std::size_t i = 0; i < swept_.size(); ++i)
    nodes_.observations[i].turns[nodes_.observations[i].joint] = swept_[i];
}

template <int Size>
NormalEquations ChainProblem<Size>::linearised(const Chain& chain) {
  const auto all = EffectElimination(products(chain), nodes_.group_of, nodes_.home_of,
                                     columns_.home(), count_all(chain))(variances_);
  NormalEquations equations{all.normal, all.gradient, all.squares / 2};
  leave_out_rounding({chain.axes.size(), chain.targets_mm.size()}, equations);
  const Eigen::VectorXd known = prior(chain);
  equations.normal.diagonal() += known;
  Eigen::Index at = count(chain);
  const auto pull = [&](double here) {
    equations.gradient(at) -= known(at) * here;
    equations.cost += known(at) * here * here / 2;
    ++at;
  };
  for (const double zero : chain.zero_rad) pull(zero);
  for (const ChainSag& sag : chain.sags) pull(sag.rad);
  for (Eigen::Index k = 0; k < shape_.drift_columns(); ++k) pull(chain.drift_mm(k % 3, k / 3));
  for (Eigen::Index k = 0; at < known.size(); ++k) pull(chain.move(k));
  return equations;
}

template <int Size>
Eigen::VectorXd ChainProblem<Size>::prior(const Chain& chain) const {
  Eigen::VectorXd known = Eigen::VectorXd::Zero(count_all(chain));
  for (std::size_t j = 0; j < shape_.zero_rad.size(); ++j)
    if (shape_.zero_rad[j] > 0)
      known(count(chain) + static_cast<Eigen::Index>(j)) =
          1 / (shape_.zero_rad[j] * shape_.zero_rad[j]);
  for (std::size_t s = 0; s < chain.sags.size(); ++s) {
    const double sigma_rad = chain.sags[s].share * shape_.sag_rad;
    known(first_sag(chain) + static_cast<Eigen::Index>(s)) = 1 / (sigma_rad * sigma_rad);
  }
  const Eigen::VectorXd device =
      device_sigmas(shape_, shape_, count_all(chain) - first_move(chain));
  known.tail(device.size()) = device.cwiseAbs2().cwiseInverse();
  return known;
}

template <int Size>
std::vector<StrokeProducts> ChainProblem<Size>::products(const Chain& chain) {
  std::vector<StrokeProducts> found;
  ChainPose pose(chain);
  for (std::size_t u = 0; u < nodes_.units.size(); ++u) found.push_back(unit(chain, u, pose));
  return found;
}

template <int Size>
StrokeProducts ChainProblem<Size>::unit(const Chain& chain, std::size_t u, ChainPose& pose) {
  StrokeProducts result;
  result.stand = nodes_.stand[u];
  const std::vector<Eigen::Index> which = active(chain, nodes_.units[u]);
  const std::vector<HomeColumn> of_home = home_columns(u);
  for (const HomeColumn& one : of_home) result.outer.push_back(one.at);
  for (const Eigen::Index parameter : which) result.outer.push_back(columns_.home() + parameter);
  Eigen::Index nodes = 0;
  for (const std::size_t s : nodes_.units[u])
    nodes += static_cast<Eigen::Index>(nodes_.strokes[s].nodes.size());
  const auto parameters = static_cast<Eigen::Index>(which.size());
  const Eigen::Index at_home = columns_.own + columns_.stand + columns_.shared();
  const Eigen::Index first = at_home + static_cast<Eigen::Index>(of_home.size());
  const Eigen::Index last = first + parameters;
  rows_.setZero(last + 1, Size * nodes);
  weighted_.resize(last + 1, Size * nodes);
  Eigen::Index column = 0;
  for (const std::size_t s : nodes_.units[u]) {
    const StrokeMoments& stroke = nodes_.strokes[s];
    for (std::size_t n = 0; n < stroke.nodes.size(); ++n, column += Size) {
      const std::size_t i = nodes_.first[s] + n;
      const ChainObservation& seen = nodes_.observations[i];
      auto block = rows_.template middleCols<Size>(column);
      pose.set(seen.target, turns_of(chain, seen, noise_), true);
      if (at_home > 0) set_effects(u, stroke, n, seen, pose, block.topRows(at_home));
      for (std::size_t k = 0; k < of_home.size(); ++k)
        block.row(at_home + static_cast<Eigen::Index>(k)) =
            pose.by_turn[of_home[k].joint].template head<Size>().transpose();
      settle(chain, i, pose);
      Turns turns = seen.turns;
      if (free(seen)) turns[seen.joint] = swept_[i];
      const auto levers = sag_levers(chain, turns);
      Eigen::Matrix3Xd moves;
      if (shape_.moved_mm > 0) moves = chain.by_move(seen.target, pose.position_mm, pose.rotation);
      for (Eigen::Index a = 0; a < parameters; ++a) {
        const Eigen::Index at = which[static_cast<std::size_t>(a)];
        auto row = block.row(first + a);
        if (of_another_target(chain, at, seen.target)) continue;
        if (at < count(chain)) {
          row = pose.by_parameter.col(at).template head<Size>().transpose();
        } else if (at < first_sag(chain)) {
          row = residual_.by_swept.transpose();
        } else if (at < first_drift(chain)) {
          const auto sag = static_cast<std::size_t>(at - first_sag(chain));
          row = levers[sag] * pose.by_turn[chain.sags[sag].joint].template head<Size>().transpose();
        } else if (at < first_move(chain)) {
          const Eigen::Index drift = at - first_drift(chain);
          row(drift % 3) = seen.times(drift / 3);
        } else if (seen.before_move) {
          row.template head<3>() = moves.col(at - first_move(chain)).transpose();
        }
      }
      block.row(last) = residual_.error.transpose();
      weighted_.template middleCols<Size>(column).noalias() =
          block * (seen.weight / stroke.correlation * residual_.weight);
    }
  }
  result.products.resize(last + 1, last + 1);
  result.products.template triangularView<Eigen::Lower>() = weighted_ * rows_.transpose();
  result.products.template triangularView<Eigen::StrictlyUpper>() = result.products.transpose();
  return result;
}

template <int Size>
std::vector<typename ChainProblem<Size>::HomeColumn> ChainProblem<Size>::home_columns(
    std::size_t u) const {
  std::vector<HomeColumn> found;
  const std::size_t swept = nodes_.strokes[nodes_.units[u].front()].content.joint;
  for (std::size_t k = 0; k < nodes_.known.size(); ++k) {
    if (k == swept || !nodes_.known[k]) continue;
    if (columns_.offset > 0) found.push_back({static_cast<Eigen::Index>(k), k});
    if (columns_.rest > 0)
      found.push_back({columns_.offset + static_cast<Eigen::Index>(*nodes_.rest_of[u][k]), k});
  }
  std::sort(found.begin(), found.end(),
            [](const HomeColumn& a, const HomeColumn& b) { return a.at < b.at; });
  return found;
}

template <int Size>
void ChainProblem<Size>::set_effects(std::size_t u, const StrokeMoments& stroke, std::size_t n,
                                     const ChainObservation& seen, const ChainPose& pose,
                                     EffectRows rows) const {
  const Eigen::Index shared = columns_.own + columns_.stand;
  const Range& range = ranges_[nodes_.group[u]];
  if (columns_.own > 0)
    rows.topRows(columns_.own) =
        own_effects<Size>(columns_, pose, nodes_.known, seen,
                          stroke.place_of(stroke.nodes[n].turn_rad), nodes_.middle_mm(u));
  // A stand's turns of the joints are a unit's, in common.
  rows.middleRows(columns_.own, columns_.stand) = rows.topRows(columns_.stand);
  const auto here = polynomials(range.place(seen.turns[seen.joint]));
  if (columns_.figure > 0) {
    // Radial and axial, nothing where the joint stands at its home's turn.
    const Turns& home_turns = nodes_.homes[nodes_.home_of[nodes_.group[u]]];
    const auto home = polynomials(range.place(home_turns[seen.joint]));
    const Eigen::Vector3d from = seen.position_mm - stroke.circle.center_mm;
    Eigen::Vector3d axial = stroke.circle.normal;
    const Eigen::Vector3d radial =
        stroke.linear ? stroke.arm : Eigen::Vector3d((from - axial.dot(from) * axial).normalized());
    // Along the joint's axis, whichever way this stroke went: others share the figure.
    if (pose.by_turn[seen.joint].template head<3>().dot(axial.cross(radial)) < 0) axial = -axial;
    const Eigen::Index at = shared + columns_.figure * static_cast<Eigen::Index>(seen.target);
    for (Eigen::Index m = 0; m < kFigureOrders; ++m) {
      const double value = here(m + 1) - home(m + 1);
      rows.row(at + m).template head<3>() = value * radial.transpose();
      rows.row(at + kFigureOrders + m).template head<3>() = value * axial.transpose();
    }
  }
  if (columns_.wander > 0)
    rows.template block<3, 3>(rows.rows() - columns_.told - 3, 0).setIdentity();
  if (columns_.told > 0 && !free(seen))
    rows.bottomRows(columns_.told) = here.template head<kFigureOrders>() *
                                     pose.by_turn[seen.joint].template head<Size>().transpose();
}

template <int Size>
void ChainProblem<Size>::settle(const Chain& chain, std::size_t i, ChainPose& pose) {
  const ChainObservation& seen = nodes_.observations[i];
  residual_.set(chain, seen, pose, weights_[i], free(seen));
  if (!free(seen)) return;
  swept_[i] = seen.turns[seen.joint] + residual_.toward;
  // Along the tangent is along the circle, unless it is far.
  constexpr double kBend = 1e-10;  // standard deviations
  if (residual_.toward * residual_.toward <= kBend * residual_.toward_sigma) return;
  Turns turns = seen.turns;
  turns[seen.joint] = swept_[i];
  pose.set(seen.target, turns_of(chain, turns, seen.joint, noise_), true);
  residual_.set(chain, seen, pose, weights_[i], true);
}

template <int Size>
bool ChainProblem<Size>::of_another_target(const Chain& chain, Eigen::Index parameter,
                                           std::size_t target) {
  const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
  return parameter >= parameters.target(0) && parameter < parameters.tool() &&
         (parameter - parameters.target(0)) / 3 != static_cast<Eigen::Index>(target);
}

template <int Size>
typename ChainProblem<Size>::Orders ChainProblem<Size>::polynomials(double x) {
  Orders values;
  double before = x, value = 1;
  for (double& order : values) {
    order = value;
    before = std::exchange(value, 2 * x * value - before);
  }
  return values;
}

template <int Size>
std::vector<Eigen::Index> ChainProblem<Size>::active(
    const Chain& chain, const std::vector<std::size_t>& strokes) const {
  const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
  std::set<Eigen::Index> found;
  const auto add = [&](Eigen::Index from, Eigen::Index count) {
    for (Eigen::Index k = 0; k < count; ++k) found.insert(from + k);
  };
  for (const std::size_t s : strokes) {
    const std::size_t begin = nodes_.first[s];
    const std::size_t end = begin + nodes_.strokes[s].nodes.size();
    const ChainObservation& first = nodes_.observations[begin];
    for (std::size_t j = 0; j < parameters.joints; ++j) {
      bool turned = j == first.joint;
      for (std::size_t i = begin; i < end && !turned; ++i)
        turned = nodes_.observations[i].turns[j] != 0;
      if (turned) add(parameters.axis(j), chain.axes[j].linear ? 2 : 4);
    }
    add(parameters.target(first.target), 3);
    if constexpr (Size == 6) add(parameters.tool(), 3);
    if (!shape_.zero_rad.empty() && shape_.zero_rad[first.joint] > 0 && !free(first))
      add(count(chain) + static_cast<Eigen::Index>(first.joint), 1);
  }
  add(first_sag(chain), count_all(chain) - first_sag(chain));
  return {found.begin(), found.end()};
}

template <int Size>
bool ChainProblem<Size>::free(const ChainObservation& seen) const {
  return std::isinf(noise_.swept_rad[seen.joint]);
}

template class ChainProblem<3>;
template class ChainProblem<6>;

}  // namespace identify
