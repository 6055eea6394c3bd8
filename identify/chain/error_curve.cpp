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

void ErrorCurve::Stroke::add(double turn, bool falling, double samples, const Errors& errors) {
  const Index last = size() - 1;
  rows_.resize(size(), errors.mean.size());
  rows_.topRows(effects_) = errors.by_effects;
  rows_.middleRows<Row::SizeAtCompileTime>(effects_) = regressors(turn, falling) * errors.by_turn;
  rows_.row(last) = errors.mean;
  weighted_.noalias() = samples * rows_ * errors.weight;
  products_.triangularView<Eigen::Lower>() += weighted_ * rows_.transpose();
  products_(last, last) += errors.within.cwiseProduct(errors.weight).sum();
  samples_ += samples;
  (falling ? falls_ : rises_) = true;
}

void ErrorCurve::Stroke::add(double turn, bool falling, double samples, double error, double within,
                             double weight) {
  const auto one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
  add(turn, falling, samples,
      {Eigen::MatrixXd(0, 1), one(1), one(error), one(within), one(weight)});
}

void ErrorCurve::add(const Stroke& stroke, const Eigen::Ref<const Eigen::VectorXd>& variances,
                     double level) {
  double log_determinant = 0;
  Eigen::MatrixXd left = without_effects(stroke.products_, variances, log_determinant);
  constexpr Index kLast = Row::SizeAtCompileTime;
  const Eigen::VectorXd by_level = left.col(0);
  const double share = level / (1 + level * by_level(0));
  for (Index c = 0; c < left.cols(); ++c) left.col(c) -= share * by_level(c) * by_level;
  normal_ += decltype(normal_)(left.topLeftCorner<kLast, kLast>().selfadjointView<Eigen::Lower>());
  right_ += left.bottomLeftCorner<1, kLast>().transpose();
  squares_ += left(kLast, kLast);
  samples_ += stroke.samples_;
  rises_ = rises_ || stroke.rises_;
  falls_ = falls_ || stroke.falls_;
}

ErrorCurve::Level ErrorCurve::level_of(const Stroke& stroke,
                                       const Eigen::Ref<const Eigen::VectorXd>& variances,
                                       const Fit& fit) {
  double log_determinant = 0;
  const Eigen::VectorXd by_level =
      without_effects(stroke.products_, variances, log_determinant).col(0);
  constexpr Index kLast = Row::SizeAtCompileTime;
  if (!(by_level(0) > 0)) return {0, 0, stroke.falls_};
  return {(by_level(kLast) - by_level.head<kLast>().dot(fit.coefficients)) / by_level(0),
          by_level(0), stroke.falls_};
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
