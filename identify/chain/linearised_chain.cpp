#include "identify/chain/linearised_chain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/chain/chain_problem.hpp"
#include "identify/chain/information.hpp"

namespace identify {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LinearisedChain::LinearisedChain(const Chain& chain, ChainNodes& nodes, const ChainNoise& noise,
                                 const ChainEffects& shape, bool with_orientation)
    : nodes_(nodes), shape_(shape), columns_(shape, nodes) {
  sags_.resize(static_cast<Eigen::Index>(chain.sags.size()));
  for (std::size_t s = 0; s < chain.sags.size(); ++s)
    sags_(static_cast<Eigen::Index>(s)) = chain.sags[s].rad;
  const auto set = [&](auto&& problem) {
    strokes_ = problem.products(chain);
    prior_ = problem.prior(chain);
  };
  if (with_orientation)
    set(ChainProblem<6>(chain, nodes, noise, shape));
  else
    set(ChainProblem<3>(chain, nodes, noise, shape));
}

double LinearisedChain::deviance(const ChainEffects& effects) const {
  auto all =
      eliminate(strokes_, nodes_.home_of, variances_of(effects, nodes_, columns_), prior_.size());
  // Nothing would be left to say what strokes differ by if sags could be anything.
  const VectorXd known = prior_.tail(sags_.size());
  all.normal.diagonal().tail(sags_.size()) += known;
  all.gradient.tail(sags_.size()) -= known.cwiseProduct(sags_);
  all.squares += sags_.dot(known.cwiseProduct(sags_));
  // By Cholesky's factors where all is determined, which is many times faster.
  const VectorXd scale = all.normal.diagonal().cwiseSqrt().cwiseInverse();
  if (scale.allFinite()) {
    const Eigen::LLT<MatrixXd> factors(scale.asDiagonal() * all.normal * scale.asDiagonal());
    const VectorXd pivots = factors.matrixLLT().diagonal();
    if (factors.info() == Eigen::Success && pivots.minCoeff() > std::sqrt(kNoInformation)) {
      const VectorXd side = factors.matrixL().solve(scale.cwiseProduct(all.gradient));
      return all.log_determinant + 2 * (pivots.array() / scale.array()).log().sum() + all.squares -
             side.squaredNorm();
    }
  }
  const Information information(all.normal);
  const VectorXd step = information.step(all.gradient, 0);
  return all.log_determinant + information.log_determinant() + all.squares - step.dot(all.gradient);
}

std::vector<ChainEstimate::Part> LinearisedChain::parts() const {
  const EffectVariances all = variances_of(shape_, nodes_, columns_);
  const auto normal_at = [&](const EffectVariances& variances) -> MatrixXd {
    return eliminate(strokes_, nodes_.home_of, variances, prior_.size()).normal;
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
  drift.drift_mm = shape_.drift_mm;
  figure.figure_mm = shape_.figure_mm;
  offset.offset_rad = shape_.offset_rad;
  print.print_mm = shape_.print_mm;
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
