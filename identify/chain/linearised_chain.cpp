#include "identify/chain/linearised_chain.hpp"

#include <algorithm>
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
  const Eigen::Index drift = shape.drift_columns();
  const Eigen::Index move = shape.moved_mm > 0 ? chain.move.size() : 0;
  last_.resize(sags + drift + move);
  sag_shares_.resize(sags);
  for (Eigen::Index s = 0; s < sags; ++s) {
    last_(s) = chain.sags[static_cast<std::size_t>(s)].rad;
    sag_shares_(s) = chain.sags[static_cast<std::size_t>(s)].share;
  }
  last_.segment(sags, drift) = chain.drift_mm.reshaped().head(drift);
  last_.tail(move) = chain.move.head(move);
  const auto set = [&](auto&& problem) {
    prior_ = problem.prior(chain);
    eliminated_.emplace(problem.products(chain), nodes.group_of, nodes.home_of, columns_.home(),
                        prior_.size());
  };
  if (with_orientation)
    set(ChainProblem<6>(chain, nodes, noise, shape));
  else
    set(ChainProblem<3>(chain, nodes, noise, shape));
  const Eigen::Index others = prior_.size() - last_.size();
  const MatrixXd noise_alone = (*eliminated_)(variances_of({}, nodes, columns_)).normal;
  determined_ = Information(noise_alone.topLeftCorner(others, others)).determined();
}

// Along the determined directions alone. Whichever effects there are, it is of the same directions:
// one more or less would be worth the logarithm of what rounding leaves of it. Infinite where the
// effects are so large that rounding is most of what they leave.
LinearisedChain::Left LinearisedChain::left_by(const ChainEffects& effects) {
  const Eliminated all = (*eliminated_)(variances_of(effects, nodes_, columns_));
  const Eigen::Index last = last_.size(), others = prior_.size() - last;
  Left left{MatrixXd(last + 1, last + 1), all.log_determinant};
  MatrixXd sides(others, last + 1);
  sides.leftCols(last) = all.normal.topRightCorner(others, last);
  sides.col(last) = all.gradient.head(others) + sides.leftCols(last) * last_;
  const auto own = all.normal.bottomRightCorner(last, last);
  const VectorXd moved = own * last_;
  left.products.topLeftCorner(last, last) = own;
  left.products.col(last).head(last) = all.gradient.tail(last) + moved;
  left.products.row(last).head(last) = left.products.col(last).head(last).transpose();
  left.products(last, last) = all.squares + last_.dot(2 * all.gradient.tail(last) + moved);
  if (determined_.cols() == 0) return left;
  const Eigen::LLT<MatrixXd> factors(determined_.transpose() *
                                     all.normal.topLeftCorner(others, others) * determined_);
  constexpr double kFine = 1e-13;  // of what noise alone leaves
  const VectorXd pivots = factors.matrixLLT().diagonal().cwiseAbs2();
  if (factors.info() != Eigen::Success || !(pivots.minCoeff() > kFine)) {
    left.log_determinant = std::numeric_limits<double>::infinity();
    return left;
  }
  const MatrixXd solved = factors.matrixL().solve(determined_.transpose() * sides);
  left.log_determinant += pivots.array().log().sum();
  left.products -= solved.transpose() * solved;
  return left;
}

double LinearisedChain::deviance(const Left& left, const ChainEffects& effects) const {
  VectorXd sigma(last_.size());
  const Eigen::Index sags = sag_shares_.size();
  sigma.head(sags) = effects.sag_rad * sag_shares_;
  sigma.tail(last_.size() - sags) =
      device_sigmas(shape_, effects, last_.size() - sags - shape_.drift_columns());
  double log_determinant = left.log_determinant;
  const MatrixXd rest = without_effects(left.products, sigma.cwiseAbs2(), log_determinant);
  return log_determinant + rest(rest.rows() - 1, rest.cols() - 1);
}

double LinearisedChain::deviance(const ChainEffects& effects) {
  return deviance(left_by(effects), effects);
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
  const Eigen::Index sags = sag_shares_.size();
  const auto add = [&](Cause cause, const MatrixXd& information) {
    found.push_back({cause, covariance * information * covariance});
    left -= found.back().covariance;
  };
  ChainEffects home, drift, figure, offset, print;
  home.home_rad = shape_.home_rad;
  home.home_lasts = shape_.home_lasts;
  home.creep_rad = shape_.creep_rad;
  home.home_times = shape_.home_times;
  home.along = shape_.along;
  home.places_rad = shape_.places_rad;
  drift.drift_mm = shape_.drift_mm;
  drift.stray_mm = shape_.stray_mm;
  figure.figures_mm = shape_.figures_mm;
  figure.figure_times = shape_.figure_times;
  offset.offset_rad = shape_.offset_rad;
  print.print_mm = shape_.print_mm;
  print.print_rad = shape_.print_rad;
  print.print_turn_rad = shape_.print_turn_rad;
  print.late_s = shape_.late_s;
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
      variances.own += by * own.own;
      variances.stand += by * own.stand;
      variances.shared += by * own.shared;
      variances.home += by * own.home;
      return normal_at(variances);
    };
    MatrixXd information = (changed(-kStep) - changed(kStep)) / (2 * kStep);
    const Eigen::Index others = prior_.size() - last_.size();
    if (cause == Cause::print) information.diagonal().head(others) += prior_.head(others);
    const Eigen::Index steady = last_.size() - sags;
    if (cause == Cause::drift) information.diagonal().tail(steady) += prior_.tail(steady);
    if (!information.isZero(0)) add(cause, information);
  }
  if (sags > 0) {
    const Eigen::Index first = prior_.size() - last_.size();
    MatrixXd information = MatrixXd::Zero(prior_.size(), prior_.size());
    information.diagonal().segment(first, sags) = prior_.segment(first, sags);
    add(Cause::sag, information);
  }
  found.push_back({Cause::noise, left});
  std::rotate(found.begin(), found.end() - 1, found.end());
  return found;
}

}  // namespace identify
