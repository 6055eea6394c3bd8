#include "identify/chain/chain_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Adds to `sum`, whose columns are (first ones, all parameters, y), products whose columns are
/// (the same first ones, these parameters, y).
void add(MatrixXd& sum, Index first, Index parameters, const MatrixXd& products,
         const std::vector<Index>& which) {
  const Index size = first + parameters + 1;
  if (sum.size() == 0) sum = MatrixXd::Zero(size, size);
  std::vector<Index> place;
  for (Index k = 0; k < first; ++k) place.push_back(k);
  for (const Index parameter : which) place.push_back(first + parameter);
  place.push_back(size - 1);
  for (Index c = 0; c < products.cols(); ++c)
    for (Index r = 0; r < products.rows(); ++r)
      sum(place[static_cast<std::size_t>(r)], place[static_cast<std::size_t>(c)]) += products(r, c);
}

}  // namespace

// In units of the effects' own standard deviations, so that a variance may be zero.
MatrixXd without_effects(const MatrixXd& products, const VectorXd& variances,
                         double& log_determinant) {
  const Index effects = variances.size();
  const Index rest = products.rows() - effects;
  if (effects == 0) return products;
  const VectorXd sigma = variances.cwiseSqrt();
  MatrixXd inner =
      sigma.asDiagonal() * products.topLeftCorner(effects, effects) * sigma.asDiagonal();
  inner.diagonal().array() += 1;
  const Eigen::LLT<MatrixXd> solver(inner);
  const MatrixXd side =
      solver.matrixL().solve(MatrixXd(sigma.asDiagonal() * products.topRightCorner(effects, rest)));
  log_determinant += 2 * solver.matrixLLT().diagonal().array().log().sum();
  // The unit matrix and squares have no pivot below one. Where a stroke has gaps, nodes may have
  // negative weights: of effects so large that this shows, its sums tell nothing.
  constexpr double kRounding = 1e-14;
  const double least = 0.99 - kRounding * inner.diagonal().maxCoeff();
  if (solver.info() != Eigen::Success ||
      !(solver.matrixLLT().diagonal().cwiseAbs2().minCoeff() > least))
    log_determinant = std::numeric_limits<double>::infinity();
  MatrixXd left = products.bottomRightCorner(rest, rest);
  left.selfadjointView<Eigen::Lower>().rankUpdate(side.transpose(), -1);
  left.triangularView<Eigen::StrictlyUpper>() = left.transpose();
  return left;
}

EffectElimination::EffectElimination(std::vector<StrokeProducts> strokes,
                                     std::vector<std::size_t> home_of, Index parameters)
    : strokes_(std::move(strokes)), home_of_(std::move(home_of)), parameters_(parameters) {
  own_.left.resize(home_of_.size());
}

Eliminated EffectElimination::operator()(const EffectVariances& variances) {
  if (own_.variances != variances.own) {
    shared_.variances.clear();
    own_.variances = variances.own;
    own_.log_determinant = 0;
    for (MatrixXd& group : own_.left) group.setZero();
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      const std::size_t group = strokes_[s].group;
      add(own_.left[group], variances.shared[group].size() + variances.home[home_of_[group]].size(),
          parameters_,
          without_effects(strokes_[s].products, variances.own[s], own_.log_determinant),
          strokes_[s].parameters);
    }
  }
  if (shared_.variances != variances.shared) {
    shared_.variances = variances.shared;
    shared_.log_determinant = own_.log_determinant;
    shared_.left.resize(variances.home.size());
    for (MatrixXd& home : shared_.left) home.setZero();
    for (std::size_t g = 0; g < home_of_.size(); ++g) {
      if (own_.left[g].size() == 0) continue;  // no stroke is of it
      MatrixXd& home = shared_.left[home_of_[g]];
      const MatrixXd left =
          without_effects(own_.left[g], variances.shared[g], shared_.log_determinant);
      if (home.size() == 0)
        home = left;
      else
        home += left;
    }
  }
  Eliminated all;
  all.log_determinant = shared_.log_determinant;
  MatrixXd whole = MatrixXd::Zero(parameters_ + 1, parameters_ + 1);
  for (std::size_t h = 0; h < shared_.left.size(); ++h)
    if (shared_.left[h].size() > 0)
      whole += without_effects(shared_.left[h], variances.home[h], all.log_determinant);
  all.normal = whole.topLeftCorner(parameters_, parameters_);
  all.gradient = whole.topRightCorner(parameters_, 1);
  all.squares = whole(parameters_, parameters_);
  return all;
}

EffectColumns::EffectColumns(const ChainEffects& shape, const ChainNodes& nodes)
    : targets(nodes.targets) {
  const auto turns = static_cast<Index>(nodes.known.size());
  if (shape.home_rad > 0 || shape.drift_mm > 0 || shape.print_mm > 0 || shape.print_rad > 0)
    own = turns + 6;
  if (shape.print_rad > 0) own += turned = 6;
  if (shape.figure_mm() > 0) figure = 2 * kFigureOrders;
  if (shape.told_rad > 0) told = kFigureOrders;
  if (shape.offset_rad > 0) home = turns;
}

namespace {

/// How large the coefficients of a law's orders are, from the first on, that of the first being
/// one. `arc_rad`: half of it.
VectorXd fall_of(FigureLaw law, double arc_rad) {
  VectorXd sizes(kFigureOrders);
  for (Index m = 0; m < kFigureOrders; ++m) {
    const auto order = static_cast<double>(m + 1);
    if (law != FigureLaw::waves || arc_rad == 0) {
      sizes(m) = std::pow(order, law == FigureLaw::square ? -2 : -3);
      continue;
    }
    // cos(k q) and sin(k q) over the arc: 2 J_m(k arc) (Abramowitz & Stegun, 9.1.44 f.).
    constexpr std::array kWaves{7.5, 1.0, 0.3};
    double squares = 0;
    for (std::size_t k = 0; k < kWaves.size(); ++k)
      squares += std::pow(
          kWaves[k] * std::cyl_bessel_j(order, static_cast<double>(k + 1) * std::min(arc_rad, kPi)),
          2);
    sizes(m) = std::sqrt(squares);
  }
  return sizes / sizes(0);
}

VectorXd figure_variances(const ChainEffects& effects, double arc_rad) {
  VectorXd variances = VectorXd::Zero(kFigureOrders);
  for (std::size_t law = 0; law < kFigureLaws.size(); ++law)
    if (effects.figures_mm[law] > 0)
      variances += (effects.figures_mm[law] * fall_of(kFigureLaws[law], arc_rad)).cwiseAbs2();
  return variances;
}

}  // namespace

EffectVariances variances_of(const ChainEffects& effects, const ChainNodes& nodes,
                             const EffectColumns& columns) {
  EffectVariances variances;
  const auto turns = static_cast<Index>(nodes.known.size());
  double begin_s = std::numeric_limits<double>::infinity(), end_s = -begin_s;
  for (const StrokeMoments& stroke : nodes.strokes) {
    begin_s = std::min(begin_s, stroke.begin_s);
    end_s = std::max(end_s, stroke.end_s);
  }
  for (const auto& unit : nodes.units) {
    const StrokeMoments& stroke = nodes.strokes[unit.front()];
    VectorXd own = VectorXd::Zero(columns.own);
    if (columns.own > 0) {
      own.head(turns).setConstant(effects.home_rad * effects.home_rad);
      own.segment<6>(turns).setConstant(effects.drift_mm * effects.drift_mm);
      // A random walk's variance over a time D is D/6 a unit of time, that of its slope over a
      // stroke of length T 3/10 T (of half the change from end to end).
      const double share = std::min(1.0, 6 * (stroke.end_s - stroke.begin_s) / (end_s - begin_s));
      own.segment<3>(turns + 3) *= share > 0 ? 0.3 * share : 0.3;
      const auto shifts = stroke.rounding.shifts(effects.print_mm, effects.print_rad);
      for (Index at = 0; at <= columns.turned; at += 6) {
        own.segment<3>(turns + at) += shifts.level.segment<3>(at / 2).matrix();
        own.segment<3>(turns + at + 3) += shifts.growth.segment<3>(at / 2).matrix();
      }
    }
    variances.own.push_back(std::move(own));
  }
  std::vector<double> arcs(nodes.home_of.size());  // of the groups; half of them
  for (std::size_t u = 0; u < nodes.units.size(); ++u)
    for (const std::size_t s : nodes.units[u]) {
      double& arc = arcs[nodes.group[u]];
      arc = std::max(arc, (nodes.strokes[s].to_rad - nodes.strokes[s].from_rad) / 2);
    }
  for (const double arc : arcs) {
    VectorXd shared(columns.shared());
    const VectorXd figure = columns.figure > 0 ? figure_variances(effects, arc) : VectorXd();
    for (Index at = 0; at + columns.told < shared.size(); ++at)
      shared(at) = figure(at % kFigureOrders);
    shared.tail(columns.told).setConstant(effects.told_rad * effects.told_rad);
    variances.shared.push_back(std::move(shared));
  }
  variances.home.assign(nodes.homes.size(),
                        VectorXd::Constant(columns.home, effects.offset_rad * effects.offset_rad));
  variances.home.front().setZero();
  return variances;
}

}  // namespace identify
