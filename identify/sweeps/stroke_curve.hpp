#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "identify/geometry/angle.hpp"

namespace identify {

/// Chebyshev nodes over a section of the turn, and the Lagrange polynomials through them by the
/// second barycentric formula (Berrut & Trefethen 2004, eqs. 4.2 and 5.3).
class Lagrange {
 public:
  static constexpr std::size_t kMostNodes = 12;
  using Values = std::array<double, kMostNodes>;

  Lagrange(double from, double to, std::size_t nodes) : count_(nodes) {
    for (std::size_t k = 0; k < count_; ++k) {
      const double angle =
          (2 * static_cast<double>(k) + 1) * kPi / (2 * static_cast<double>(count_));
      nodes_[k] = (from + to) / 2 + (to - from) / 2 * std::cos(angle);
      factors_[k] = (k % 2 == 0 ? 1 : -1) * std::sin(angle);
    }
  }
  [[nodiscard]] double node(std::size_t k) const { return nodes_[k]; }
  void at(double x, Values& values) const {
    double sum = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const double apart = x - nodes_[k];
      if (apart == 0) {
        values.fill(0);
        values[k] = 1;
        return;
      }
      values[k] = factors_[k] / apart;
      sum += values[k];
    }
    for (std::size_t k = 0; k < count_; ++k) values[k] /= sum;
  }

 private:
  std::size_t count_;
  Values nodes_{}, factors_{};
};

/// A stroke's own smooth curve: least squares by Chebyshev polynomials of the turn.
class StrokeCurve {
 public:
  StrokeCurve(const std::vector<double>& turns, double from, double to, Eigen::Index orders);
  [[nodiscard]] Eigen::Index orders() const { return basis_.rows(); }
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
