#include "identify/sweeps/stroke_curve.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/median.hpp"
#include "identify/geometry/spread.hpp"

namespace identify {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;

StrokeCurve::StrokeCurve(const ArrayXd& turns, double from, double to, Index orders)
    : basis_(orders, turns.size()) {
  basis_.row(0).setOnes();
  const double half = (to - from) / 2;
  set_chebyshev(basis_, half > 0 ? ArrayXd((turns - (from + to) / 2) / half)
                                 : ArrayXd(ArrayXd::Zero(turns.size())));
}

void StrokeCurve::weigh(const ArrayXd& weights) {
  if (weights_.size() == weights.size() && (weights_ == weights).all()) return;
  weights_ = weights;
  MatrixXd normal = (basis_.rowwise() * weights.transpose()).matrix() * basis_.matrix().transpose();
  normal.diagonal() *= 1 + 1e-12;
  normal_.compute(normal);
}

SampleRows StrokeCurve::left(const Eigen::Ref<const SampleRows>& errors) const {
  const MatrixXd found = normal_.solve(
      basis_.matrix() * (errors.rowwise() * weights_.transpose()).matrix().transpose());
  return errors - (found.transpose() * basis_.matrix()).array();
}

ArrayXd distances_of(const Eigen::Ref<const SampleRows>& errors, double least,
                     double least_of_told) {
  constexpr double kLeast = 1e-10;
  ArrayXd farthest = ArrayXd::Zero(errors.cols());
  ArrayXd sizes;
  for (Index d = 0; d < errors.rows(); ++d) {
    sizes = errors.row(d).abs();
    const double middle = median_in({sizes.data(), static_cast<std::size_t>(sizes.size())});
    const double sigma = std::max(
        {kLeast, d < 2 ? least : least_of_told, for_few(errors.cols()) * middle * kSigmaByMedian});
    farthest = farthest.max(errors.row(d).abs().transpose() / sigma);
  }
  return farthest;
}

ArrayXd weights_of(const ArrayXd& distances, Index directions, double wide) {
  constexpr double kPlateau = 2.5;  // a distance that a good sample hardly passes
  const double plateau = wide * (std::sqrt(static_cast<double>(directions)) + kPlateau);
  return (2 - distances / plateau).max(0).min(1).square();
}

}  // namespace identify
