#pragma once

#include <vector>

#include <Eigen/Core>

namespace identify {

/// A stroke's own smooth curve: least squares by Chebyshev polynomials of the turn.
class StrokeCurve {
 public:
  StrokeCurve(const std::vector<double>& turns, double from, double to, Eigen::Index orders);
  /// What the curve leaves of `errors`, one a column.
  [[nodiscard]] Eigen::MatrixXd left(const Eigen::MatrixXd& errors,
                                     const Eigen::VectorXd& weights) const;

 private:
  Eigen::MatrixXd basis_;
};

/// Redescending weights of errors, one a column, by the distance in standard deviations of the
/// median one, `wide` times as far as good samples need.
[[nodiscard]] Eigen::VectorXd weights_of(const Eigen::MatrixXd& left, double wide = 1);

}  // namespace identify
