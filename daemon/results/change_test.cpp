#include "daemon/results/change_test.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <Eigen/LU>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>

#include "identify/geometry/symmetric_eigen.hpp"

namespace sweepd {
namespace {

using boost::math::cdf;
using boost::math::complement;
using boost::math::quantile;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Inverse of a matrix of correlations.
MatrixXd inverse(const MatrixXd& correlations) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solved(correlations);
  const VectorXd values = solved.eigenvalues().cwiseMax(kLeastEigenvalue);
  return solved.eigenvectors() * values.cwiseInverse().asDiagonal() *
         solved.eigenvectors().transpose();
}

/// The chance that a number which changed by `shift` standard deviations is called changed: its own
/// test and the total one have to say so. What the total has beyond the number's own square is
/// independent of it: chi squared of `others` degrees, to which the shift adds by `coupling`, as
/// the other numbers correlate with it.
double power(double shift, double own_limit, double total_limit, double others, double coupling) {
  const boost::math::normal normal;
  const auto both = [&](double z) {
    const double left = total_limit - z * z;
    double rest = 1;
    if (left > 0 && others > 0)
      rest = cdf(
          complement(boost::math::non_central_chi_squared(others, coupling * shift * shift), left));
    else if (left > 0)
      rest = 0;
    return pdf(normal, z - shift) * rest;
  };
  const double certain = std::max(own_limit, std::sqrt(total_limit));
  const double beyond = cdf(complement(normal, certain - shift));
  if (certain <= own_limit) return beyond;
  return beyond + boost::math::quadrature::gauss<double, 15>::integrate(both, own_limit, certain);
}

double smallest_change(double own_limit, double total_limit, double others, double coupling) {
  const auto missing = [&](double shift) {
    return power(shift, own_limit, total_limit, others, coupling) - kPower;
  };
  const double low = own_limit;  // found in half of the cases at most
  const double high = std::max(own_limit, std::sqrt(total_limit)) + 2;
  std::uintmax_t steps = 30;
  const auto bracket = boost::math::tools::toms748_solve(
      missing, low, high, [](double a, double b) { return b - a < 1e-3; }, steps);
  return 0.5 * (bracket.first + bracket.second);
}

/// Generalised least squares of the changed numbers alone.
void set_changes(ChangeTest& test, const VectorXd& z, const VectorXd& sigma,
                 const MatrixXd& information) {
  const Index count = z.size();
  std::vector<Index> changed;
  for (Index k = 0; k < count; ++k)
    if (test.numbers[static_cast<std::size_t>(k)].changed) changed.push_back(k);
  test.changes = VectorXd::Zero(count);
  test.changes_covariance = MatrixXd::Zero(count, count);
  if (changed.empty()) return;
  const MatrixXd covariance = information(changed, changed).inverse();
  test.changes(changed) = sigma(changed).cwiseProduct(covariance * (information * z)(changed));
  test.changes_covariance(changed, changed) =
      sigma(changed).asDiagonal() * covariance * sigma(changed).asDiagonal();
}

}  // namespace

ChangeTest test_change(const VectorXd& difference, const MatrixXd& covariance, double level,
                       Smallest smallest) {
  ChangeTest test;
  const Index count = difference.size();
  if (count == 0) return test;
  const VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const VectorXd z = difference.cwiseQuotient(sigma);
  const MatrixXd information =
      inverse(sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal());
  const auto numbers = static_cast<double>(count);
  const boost::math::chi_squared total(numbers);
  const boost::math::normal normal;
  test.t_squared = z.dot(information * z);
  test.p = cdf(complement(total, test.t_squared));
  test.changed = test.p < level;

  std::vector<std::size_t> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto size = [&](std::size_t k) { return std::abs(z(static_cast<Index>(k))); };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  const double own_limit = quantile(complement(normal, level / 2 / numbers));
  const double total_limit = quantile(complement(total, level));
  test.numbers.resize(order.size());
  double p = test.p;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const auto k = static_cast<Index>(order[rank]);
    NumberChange& number = test.numbers[order[rank]];
    const double alone = 2 * cdf(complement(normal, size(order[rank])));
    p = std::max(p, std::min(1.0, (numbers - static_cast<double>(rank)) * alone));
    number.sigma = sigma(k);
    number.p = p;
    number.changed = p < level;
    if (smallest == Smallest::left_out) continue;
    number.smallest = sigma(k) * smallest_change(own_limit, total_limit, numbers - 1,
                                                 std::max(0.0, information(k, k) - 1));
  }
  set_changes(test, z, sigma, information);
  return test;
}

}  // namespace sweepd
