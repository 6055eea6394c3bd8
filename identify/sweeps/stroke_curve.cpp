#include "identify/sweeps/stroke_curve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/geometry/median.hpp"

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

StrokeCurve::StrokeCurve(const std::vector<double>& turns, double from, double to, Index orders)
    : basis_(orders, static_cast<Index>(turns.size())) {
  for (Index i = 0; i < basis_.cols(); ++i) {
    const double x =
        to > from ? (2 * turns[static_cast<std::size_t>(i)] - from - to) / (to - from) : 0;
    double before = 1, value = x;
    for (Index m = 0; m < orders; ++m) {
      basis_(m, i) = m == 0 ? 1 : value;
      if (m > 0) before = std::exchange(value, 2 * x * value - before);
    }
  }
}

MatrixXd StrokeCurve::left(const MatrixXd& errors, const VectorXd& weights) const {
  const MatrixXd weighted = basis_ * weights.asDiagonal();
  MatrixXd normal = weighted * basis_.transpose();
  normal.diagonal() *= 1 + 1e-12;
  const MatrixXd found = normal.ldlt().solve(weighted * errors.transpose());
  return errors - found.transpose() * basis_;
}

VectorXd weights_of(const MatrixXd& left, double wide) {
  const auto directions = static_cast<double>(left.rows());
  // The farthest direction counts: what a locked joint's wobble does is in more than one.
  VectorXd farthest = VectorXd::Zero(left.cols());
  for (Index d = 0; d < left.rows(); ++d) {
    std::vector<double> sizes(static_cast<std::size_t>(left.cols()));
    for (Index i = 0; i < left.cols(); ++i)
      sizes[static_cast<std::size_t>(i)] = std::abs(left(d, i));
    constexpr double kMedianOfNormal = 0.6745;
    const double sigma = std::max(1e-10, median_of(std::move(sizes)) / kMedianOfNormal);
    farthest = farthest.cwiseMax(left.row(d).transpose().cwiseAbs() / sigma);
  }
  VectorXd weights(left.cols());
  constexpr double kPlateau = 2.5;  // a distance that a good sample hardly passes
  const double plateau = wide * (std::sqrt(directions) + kPlateau);
  for (Index i = 0; i < weights.size(); ++i) {
    const double share = std::clamp(2 - farthest(i) / plateau, 0.0, 1.0);
    weights(i) = share * share;
  }
  return weights;
}

}  // namespace identify
