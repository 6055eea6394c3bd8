#include "identify/chain/error_curve.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include "identify/chain/chain_effects.hpp"

namespace identify {

using Eigen::Index;

ErrorCurve::Row ErrorCurve::regressors(double turn, bool falling) {
  Row row;
  row(0) = 1;
  row(1) = turn;
  for (Index k = 1; k <= 6; ++k) {
    row(2 * k) = std::cos(static_cast<double>(k) * turn) - 1;
    row(2 * k + 1) = std::sin(static_cast<double>(k) * turn);
  }
  row(kBacklash) = falling ? 0.5 : -0.5;
  return row;
}

ErrorCurve::Stroke::Stroke(Index effects)
    : row_(effects + Row::SizeAtCompileTime + 1),
      products_(Eigen::MatrixXd::Zero(row_.size(), row_.size())) {}

void ErrorCurve::Stroke::add(double turn, bool falling, const Eigen::VectorXd& by_effects,
                             double error, double samples, double within, double certainty) {
  row_.head(by_effects.size()) = by_effects;
  row_.segment<Row::SizeAtCompileTime>(by_effects.size()) = regressors(turn, falling);
  row_(row_.size() - 1) = error;
  products_.noalias() += (samples * certainty) * row_ * row_.transpose();
  products_(row_.size() - 1, row_.size() - 1) += within * certainty;
  samples_ += samples;
  (falling ? falls_ : rises_) = true;
}

void ErrorCurve::add(const Stroke& stroke, const Eigen::VectorXd& variances) {
  double log_determinant = 0;
  const Eigen::MatrixXd left = without_effects(stroke.products_, variances, log_determinant);
  constexpr Index kLast = Row::SizeAtCompileTime;
  normal_ += left.topLeftCorner<kLast, kLast>();
  right_ += left.topRightCorner<kLast, 1>();
  squares_ += left(kLast, kLast);
  samples_ += stroke.samples_;
  rises_ = rises_ || stroke.rises_;
  falls_ = falls_ || stroke.falls_;
}

ErrorCurve::Fit ErrorCurve::fit(Index count) const {
  std::vector<Index> chosen;
  for (Index k = 0; k < count; ++k) chosen.push_back(k);
  if (both_ways()) chosen.push_back(kBacklash);
  // Short arcs cannot tell harmonics apart: Cholesky, one regressor after the other, without
  // those that the ones before leave nothing of.
  constexpr double kLeast = 1e-9;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Row::SizeAtCompileTime,
                               Row::SizeAtCompileTime>;
  Fit found;
  std::vector<Index> kept;
  Square root = Square::Zero(static_cast<Index>(chosen.size()), static_cast<Index>(chosen.size()));
  for (const Index k : chosen) {
    const auto size = static_cast<Index>(kept.size());
    for (Index i = 0; i < size; ++i) {
      double value = normal_(k, kept[static_cast<std::size_t>(i)]);
      for (Index l = 0; l < i; ++l) value -= root(size, l) * root(i, l);
      root(size, i) = value / root(i, i);
    }
    const double left = normal_(k, k) - root.row(size).head(size).squaredNorm();
    if (!(left > kLeast * normal_(k, k))) continue;
    root(size, size) = std::sqrt(left);
    kept.push_back(k);
  }
  const auto size = static_cast<Index>(kept.size());
  found.terms = size;
  Square inverse = Square::Zero(size, size);
  for (Index c = 0; c < size; ++c)
    for (Index r = c; r < size; ++r) {
      double value = r == c ? 1 : 0;
      for (Index l = c; l < r; ++l) value -= root(r, l) * inverse(l, c);
      inverse(r, c) = value / root(r, r);
    }
  for (Index i = 0; i < size; ++i) {
    double along = 0;
    for (Index c = 0; c <= i; ++c)
      along += inverse(i, c) * right_(kept[static_cast<std::size_t>(c)]);
    found.explained += along * along;
    for (Index c = 0; c <= i; ++c) {
      const Index k = kept[static_cast<std::size_t>(c)];
      found.coefficients(k) += inverse(i, c) * along;
      found.variances(k) += inverse(i, c) * inverse(i, c);
    }
  }
  return found;
}

}  // namespace identify
