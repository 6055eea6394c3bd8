#include "identify/chain/linearised_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "identify/chain/chain_problem.hpp"
#include "identify/geometry/information.hpp"

namespace identify {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LinearisedChain::LinearisedChain(const Chain& chain, ChainNodes& nodes, const ChainNoise& noise,
                                 const ChainEffects& shape, bool with_orientation)
    : nodes_(nodes), shape_(shape), columns_(shape, nodes) {
  const auto sags = static_cast<Eigen::Index>(chain.sags.size());
  sags_.resize(sags);
  sag_shares_.resize(sags);
  for (Eigen::Index s = 0; s < sags; ++s) {
    sags_(s) = chain.sags[static_cast<std::size_t>(s)].rad;
    sag_shares_(s) = chain.sags[static_cast<std::size_t>(s)].share;
  }
  const auto set = [&](auto&& problem) {
    prior_ = problem.prior(chain);
    eliminated_.emplace(problem.products(chain), nodes.group_of, nodes.home_of, prior_.size());
  };
  if (with_orientation)
    set(ChainProblem<6>(chain, nodes, noise, shape));
  else
    set(ChainProblem<3>(chain, nodes, noise, shape));
  const Eigen::Index others = prior_.size() - sags;
  const MatrixXd noise_alone = (*eliminated_)(variances_of({}, nodes, columns_)).normal;
  determined_ = Information(noise_alone.topLeftCorner(others, others)).determined();
}

MatrixXd LinearisedChain::sags_first(const Eliminated& all) const {
  const Eigen::Index sags = sags_.size(), others = prior_.size() - sags, y = prior_.size();
  const auto order = [&](Eigen::Index k) { return k < sags ? others + k : k - sags; };
  const VectorXd bent = all.normal.rightCols(sags) * sags_;
  MatrixXd products(y + 1, y + 1);
  for (Eigen::Index c = 0; c < y; ++c) {
    for (Eigen::Index r = 0; r < y; ++r) products(r, c) = all.normal(order(r), order(c));
    products(y, c) = products(c, y) = all.gradient(order(c)) + bent(order(c));
  }
  products(y, y) = all.squares + sags_.dot(2 * all.gradient.tail(sags) + bent.tail(sags));
  return products;
}

namespace {

/// Minus twice the logarithm of the restricted likelihood, from products of (parameters, y), along
/// these directions alone. Whichever effects there are, it is of the same directions: one more or
/// less would be worth the logarithm of what rounding leaves of it. Infinite where the effects are
/// so large that rounding is most of what they leave.
double deviance_of(const MatrixXd& products, const MatrixXd& directions, double log_determinant) {
  const Eigen::Index y = products.rows() - 1;
  if (directions.cols() == 0) return log_determinant + products(y, y);
  const Eigen::LLT<MatrixXd> factors(directions.transpose() * products.topLeftCorner(y, y) *
                                     directions);
  constexpr double kFine = 1e-13;  // of what noise alone leaves
  const VectorXd pivots = factors.matrixLLT().diagonal().cwiseAbs2();
  if (factors.info() != Eigen::Success || !(pivots.minCoeff() > kFine))
    return std::numeric_limits<double>::infinity();
  const VectorXd side = factors.matrixL().solve(directions.transpose() * products.col(y).head(y));
  return log_determinant + pivots.array().log().sum() + products(y, y) - side.squaredNorm();
}

}  // namespace

std::vector<double> LinearisedChain::deviances(const ChainEffects& effects,
                                               const std::vector<double>& sags_rad) {
  const Eliminated all = (*eliminated_)(variances_of(effects, nodes_, columns_));
  const MatrixXd products = sags_first(all);
  std::vector<double> found;
  for (const double sag_rad : sags_rad) {
    double log_determinant = all.log_determinant;
    const VectorXd sigma = sag_rad * sag_shares_;
    const MatrixXd left = without_effects(products, sigma.cwiseAbs2(), log_determinant);
    found.push_back(deviance_of(left, determined_, log_determinant));
  }
  return found;
}

double LinearisedChain::deviance(const ChainEffects& effects) {
  return deviances(effects, {effects.sag_rad}).front();
}

std::vector<ChainEstimate::Part> LinearisedChain::parts() {
  const EffectVariances all = variances_of(shape_, nodes_, columns_);
  const auto normal_at = [&](const EffectVariances& variances) -> MatrixXd {
    return (*eliminated_)(variances).normal;
  };
  MatrixXd normal = normal_at(all);
  normal.diagonal() += prior_;
  const MatrixXd covariance = Information(normal).covariance();
  std::vector<ChainEstimate::Part> found;
  MatrixXd left = covariance;
  const auto add = [&](Cause cause, const MatrixXd& information) {
    found.push_back({cause, covariance * information * covariance});
    left -= found.back().covariance;
  };
  ChainEffects home, drift, figure, offset, print;
  home.home_rad = shape_.home_rad;
  home.home_stays = shape_.home_stays;
  home.home_times = shape_.home_times;
  drift.drift_mm = shape_.drift_mm;
  figure.figures_mm = shape_.figures_mm;
  figure.figure_times = shape_.figure_times;
  offset.offset_rad = shape_.offset_rad;
  print.print_mm = shape_.print_mm;
  print.print_rad = shape_.print_rad;
  print.print_turn_rad = shape_.print_turn_rad;
  print.told_rad = shape_.told_rad;
  for (const auto& [cause, effect] : {std::pair<Cause, const ChainEffects&>(Cause::home, home),
                                      {Cause::drift, drift},
                                      {Cause::figure, figure},
                                      {Cause::offset, offset},
                                      {Cause::print, print}}) {
    // The effect's variances V add K V K^T to the covariance, K = N^-1 X^T V^-1: which is
    // -N^-1 dN/ds N^-1 where V grows by s.
    constexpr double kStep = 1e-3;
    const EffectVariances own = variances_of(effect, nodes_, columns_);
    const auto changed = [&](double by) {
      EffectVariances variances = all;
      for (std::size_t s = 0; s < all.own.size(); ++s) variances.own[s] += by * own.own[s];
      for (std::size_t t = 0; t < all.stand.size(); ++t) variances.stand[t] += by * own.stand[t];
      for (std::size_t g = 0; g < all.shared.size(); ++g) variances.shared[g] += by * own.shared[g];
      for (std::size_t h = 0; h < all.home.size(); ++h) variances.home[h] += by * own.home[h];
      return normal_at(variances);
    };
    MatrixXd information = (changed(-kStep) - changed(kStep)) / (2 * kStep);
    const Eigen::Index others = prior_.size() - sags_.size();
    if (cause == Cause::print) information.diagonal().head(others) += prior_.head(others);
    if (!information.isZero(0)) add(cause, information);
  }
  if (sags_.size() > 0) {
    MatrixXd information = MatrixXd::Zero(prior_.size(), prior_.size());
    information.diagonal().tail(sags_.size()) = prior_.tail(sags_.size());
    add(Cause::sag, information);
  }
  found.push_back({Cause::noise, left});
  std::rotate(found.begin(), found.end() - 1, found.end());
  return found;
}

}  // namespace identify
