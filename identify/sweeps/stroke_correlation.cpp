#include "identify/sweeps/stroke_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace identify {
namespace {

using Eigen::Index;

/// Polynomials of the lowest `orders` at so many samples, orthonormal.
Eigen::MatrixXd orthonormal_curves(Index orders, Index samples) {
  Eigen::MatrixXd curves(samples, orders);
  for (Index i = 0; i < samples; ++i) {
    const double x = 2 * static_cast<double>(i) / static_cast<double>(samples - 1) - 1;
    double before = 1, value = x;
    for (Index m = 0; m < orders; ++m) {
      curves(i, m) = m == 0 ? 1 : value;
      if (m > 0) before = std::exchange(value, 2 * x * value - before);
    }
  }
  const Eigen::MatrixXd inner = curves.transpose() * curves;
  return inner.llt().matrixL().solve(curves.transpose()).transpose();
}

/// The mean squares of sums over 1, 2, 4, … successive errors, divided by their number, of a
/// process of unit variance whose correlation falls by the factor `falls` a sample, when these
/// curves were fitted to the samples and taken out.
Eigen::VectorXd block_variances(double falls, Index levels, const Eigen::MatrixXd& curves) {
  const Index samples = curves.rows(), orders = curves.cols();
  // Times the covariance: sums over what went before and what comes, each falling.
  Eigen::MatrixXd carried = -curves;
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(orders);
  for (Index i = 0; i < samples; ++i) carried.row(i) += sum = falls * sum + curves.row(i);
  sum.setZero();
  for (Index i = samples - 1; i >= 0; --i) carried.row(i) += sum = falls * sum + curves.row(i);
  const Eigen::MatrixXd between = curves.transpose() * carried;
  Eigen::VectorXd found(levels), part(orders), crossed(orders);
  for (Index level = 0; level < levels; ++level) {
    const Index block = Index{1} << level;
    const auto size = static_cast<double>(block);
    const double whole = falls == 0
                             ? 1
                             : (1 + falls) / (1 - falls) - 2 * falls * (1 - std::pow(falls, size)) /
                                                               (size * (1 - falls) * (1 - falls));
    double taken = 0;
    const Index blocks = samples / block;
    for (Index b = 0; b < blocks; ++b) {
      part = curves.middleRows(b * block, block).colwise().sum();
      crossed = carried.middleRows(b * block, block).colwise().sum();
      taken += 2 * part.dot(crossed) - part.dot(between * part);
    }
    found(level) = std::max(1e-6, whole - taken / static_cast<double>(blocks * block));
  }
  return found;
}

}  // namespace

double correlation_of(const std::vector<StrokeMoments>& all) {
  std::vector<const StrokeMoments*> strokes;
  for (const StrokeMoments& stroke : all)
    if (stroke.squares) strokes.push_back(&stroke);
  if (strokes.empty()) return 1;
  std::size_t levels = strokes.front()->blocks.variance_mm2.size();
  for (const auto* stroke : strokes) levels = std::min(levels, stroke->blocks.variance_mm2.size());
  if (levels < 3) return 1;
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(static_cast<Index>(levels));
  double weight = 0, freedom = 0, samples = 0;
  std::size_t orders = 0;
  for (const auto* stroke : strokes) {
    for (std::size_t b = 0; b < levels; ++b)
      seen(static_cast<Index>(b)) += stroke->weight * stroke->blocks.variance_mm2[b];
    weight += stroke->weight;
    freedom += stroke->weight * kBlockDirections;
    samples += static_cast<double>(stroke->samples) / static_cast<double>(strokes.size());
    orders = std::max(orders, stroke->blocks.curve_orders);
  }
  seen /= weight;
  if (!(seen(0) > 0)) return 1;
  seen /= seen(0);
  const Eigen::MatrixXd curves =
      orthonormal_curves(static_cast<Index>(orders), static_cast<Index>(samples));
  const auto model = [&](double falls) {
    return block_variances(falls, static_cast<Index>(levels), curves);
  };
  const Eigen::VectorXd white = model(0);
  // A mean of f squares scatters by its sqrt(2 / f); there are f / 2^b of them.
  const auto distance = [&](const Eigen::VectorXd& expected) {
    double sum = 0;
    for (std::size_t b = 0; b < levels; ++b) {
      const auto at = static_cast<Index>(b);
      const double off = std::log(std::max(1e-6, seen(at)) / expected(at));
      sum += off * off * freedom / (2 * static_cast<double>(std::size_t{1} << b));
    }
    return sum;
  };
  const double as_white = distance(white / white(0));
  double best = as_white, correlation = 1;
  for (const double falls :
       {0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.99}) {
    // What is slower than the curve's own waves is the figure's, and no noise.
    if (1 / (1 - falls) > samples / (2 * static_cast<double>(orders))) break;
    const Eigen::VectorXd slow = model(falls);
    for (int part = 1; part <= 20; ++part) {
      const double share = part / 20.0;
      const Eigen::VectorXd mixed = (1 - share) * white + share * slow;
      const double here = distance(mixed / mixed(0));
      if (here >= best) continue;
      best = here;
      correlation = ((1 - share) + share * (1 + falls) / (1 - falls)) / mixed(0);
    }
  }
  constexpr double kChanceOfWhite = 9;
  return as_white - best > kChanceOfWhite ? std::max(1.0, correlation) : 1;
}

}  // namespace identify
