#include "daemon/history/repeatability.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "daemon/results/change_test.hpp"
#include "identify/geometry/symmetric_eigen.hpp"

namespace sweepd {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Before any evidence, campaigns scatter by half of what a fit says of itself, give or take.
constexpr double kUsualShare = 0.25;
constexpr double kPriorSigma = 3;  // of logarithms: a factor of 20
/// Of the fit's own variance in any direction: less is chance, or the same data twice.
constexpr double kLeastOfFit = 0.5;
constexpr std::size_t kParameters = kVaryings + 1;
using Parameters = std::array<double, kParameters>;  // logarithms: variances, degrees beyond n + 1

double log_determinant(const Eigen::LLT<MatrixXd>& root) {
  return 2 * root.matrixLLT().diagonal().array().log().sum();
}

double log_multivariate_gamma(double x, Index n) {
  double sum = 0;
  int sign = 0;  // std::lgamma() writes it to where all threads see it
  for (Index j = 0; j < n; ++j) sum += ::lgamma_r(x - 0.5 * static_cast<double>(j), &sign);
  return sum;
}

MatrixXd with_least_eigenvalue(const MatrixXd& correlations) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solved(correlations);
  return solved.eigenvectors() * solved.eigenvalues().cwiseMax(kLeastEigenvalue).asDiagonal() *
         solved.eigenvectors().transpose();
}

/// In units of the fit's own standard deviations.
struct Structure {
  MatrixXd fit;                             // correlations
  std::array<MatrixXd, kVaryings> varying;  // empty: no such number
  std::array<double, kVaryings> unit{};     // standard deviation that 1 of it means
  Scatter scatter;

  [[nodiscard]] double count() const { return static_cast<double>(fit.rows()); }
  [[nodiscard]] MatrixXd covariance(const Parameters& at) const {
    MatrixXd sum = fit;
    for (std::size_t g = 0; g < kVaryings; ++g)
      if (varying[g].size() > 0) sum += std::exp(at[g]) * varying[g];
    return sum;
  }

  /// The logarithm, to be made large.
  [[nodiscard]] double likelihood(const Parameters& at) const {
    const double n = count();
    const double free = std::exp(at[kVaryings]);
    const double degrees = free + n + 1;
    double sum = 0;
    for (std::size_t g = 0; g < kParameters; ++g) {
      if (g < kVaryings && varying[g].size() == 0) continue;
      const double usual = g < kVaryings ? std::log(kUsualShare) : std::log(n);
      sum -= 0.5 * std::pow((at[g] - usual) / kPriorSigma, 2);
    }
    if (!(scatter.degrees > 0)) return sum;
    const MatrixXd prior = free * covariance(at);
    const Eigen::LLT<MatrixXd> before(prior), after(prior + scatter.products);
    if (before.info() != Eigen::Success || after.info() != Eigen::Success) return -1e300;
    return sum + log_multivariate_gamma((degrees + scatter.degrees) / 2, fit.rows()) -
           log_multivariate_gamma(degrees / 2, fit.rows()) + degrees / 2 * log_determinant(before) -
           (degrees + scatter.degrees) / 2 * log_determinant(after);
  }

  /// Hooke and Jeeves: the same steps in every run.
  [[nodiscard]] Parameters most_likely() const {
    Parameters at;
    at.fill(std::log(kUsualShare));
    at[kVaryings] = std::log(count());
    double best = likelihood(at);
    for (const double step : {2.0, 1.0, 0.5, 0.25, 0.125})
      for (bool better = true; better;) {
        better = false;
        for (std::size_t g = 0; g < kParameters; ++g) {
          if (g < kVaryings && varying[g].size() == 0) continue;
          for (const double by : {step, -step}) {
            Parameters next = at;
            next[g] += by;
            const double found = likelihood(next);
            if (!(found > best + 1e-9)) continue;
            best = found;
            at = next;
            better = true;
            break;
          }
        }
      }
    return at;
  }

  /// The variance of the logarithm of how large the structure is, seen by T squared.
  [[nodiscard]] double size_variance(const Parameters& at) const {
    std::vector<MatrixXd> parts;
    const MatrixXd inverse = covariance(at).inverse();
    for (std::size_t g = 0; g < kVaryings; ++g)
      if (varying[g].size() > 0) parts.push_back(inverse * (std::exp(at[g]) * varying[g]));
    const double degrees = std::exp(at[kVaryings]) + count() + 1;
    const double weight = scatter.degrees * degrees / (scatter.degrees + degrees);
    const auto size = static_cast<Index>(parts.size());
    MatrixXd information(size, size);
    VectorXd share(size);
    for (Index a = 0; a < size; ++a) {
      const MatrixXd& part = parts[static_cast<std::size_t>(a)];
      share(a) = part.trace() / count();
      for (Index b = 0; b < size; ++b)
        information(a, b) =
            weight / 2 * part.cwiseProduct(parts[static_cast<std::size_t>(b)].transpose()).sum();
      information(a, a) += 1 / (kPriorSigma * kPriorSigma);
    }
    return share.dot(information.inverse() * share);
  }
};

}  // namespace

Repeatability::Repeatability(const MatrixXd& fit, const std::vector<VaryingNumber>& numbers,
                             Scatter scatter)
    : scatter_(std::move(scatter)) {
  const Index n = fit.rows();
  if (scatter_.products.size() == 0) scatter_.products = MatrixXd::Zero(n, n);
  const VectorXd sigma = fit.diagonal().cwiseSqrt();
  const auto scaled = [&](const MatrixXd& matrix) -> MatrixXd {
    return sigma.cwiseInverse().asDiagonal() * matrix * sigma.cwiseInverse().asDiagonal();
  };
  Structure structure;
  structure.fit = with_least_eigenvalue(scaled(fit));
  structure.scatter = {scaled(scatter_.products), scatter_.degrees};
  for (std::size_t g = 0; g < kVaryings; ++g) {
    const auto kind = static_cast<Varying>(g);
    VectorXd how = VectorXd::Zero(n);
    double members = 0;
    for (Index k = 0; k < n; ++k) {
      const VaryingNumber& number = numbers[static_cast<std::size_t>(k)];
      if (kind == Varying::expansion) {
        if (number.kind == Varying::lengths) how(k) = number.length_mm / sigma(k);
      } else if (number.kind == kind) {
        how(k) = 1 / sigma(k);
      }
      if (std::abs(how(k)) > 0) ++members;
    }
    // One length that grows is one that varies.
    if (members < (kind == Varying::expansion ? 2 : 1)) continue;
    structure.unit[g] = std::sqrt(members / how.squaredNorm());
    how *= structure.unit[g];
    structure.varying[g] = kind == Varying::expansion ? MatrixXd(how * how.transpose())
                                                      : MatrixXd(how.cwiseAbs2().asDiagonal());
  }
  fit_root_ = sigma.asDiagonal() * MatrixXd(structure.fit.llt().matrixL());
  const Parameters at = structure.most_likely();
  const double free = std::exp(at[kVaryings]);
  prior_degrees_ = free + static_cast<double>(n) + 1;
  prior_ = sigma.asDiagonal() * (free * structure.covariance(at)) * sigma.asDiagonal();
  structure_variance_ = structure.size_variance(at);
  for (std::size_t g = 0; g < kVaryings; ++g)
    if (structure.varying[g].size() > 0) between_[g] = structure.unit[g] * std::exp(at[g] / 2);
  spread_ = predicted(scatter_);
}

Repeatability::Spread Repeatability::without(const VectorXd& difference, std::size_t count) const {
  if (count < 2) return spread_;
  const auto members = static_cast<double>(count);
  return predicted(
      {scatter_.products - members / (members - 1) * difference * difference.transpose(),
       scatter_.degrees - 1});
}

Repeatability::Spread Repeatability::predicted(const Scatter& scatter) const {
  const auto n = static_cast<double>(prior_.rows());
  const double own = prior_degrees_ + scatter.degrees - n + 1;
  // What is not known of the structure counts as far as it is in the covariance.
  const double share = prior_degrees_ / (prior_degrees_ + scatter.degrees);
  const auto root = fit_root_.triangularView<Eigen::Lower>();
  const MatrixXd half = root.solve((prior_ + scatter.products) / own);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solved(MatrixXd(root.solve(half.transpose())));
  const MatrixXd columns = fit_root_ * solved.eigenvectors();
  return {columns * solved.eigenvalues().cwiseMax(kLeastOfFit).asDiagonal() * columns.transpose(),
          1 / (1 / own + structure_variance_ * share * share / 2)};
}

}  // namespace sweepd
