#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace identify {

/// Eigenvalues of the normal matrix, scaled to a unit diagonal, below this carry no information.
inline constexpr double kNoInformation = 1e-9;

/// A normal matrix, scaled to a unit diagonal, by its eigenvectors.
class Information {
 public:
  explicit Information(const Eigen::MatrixXd& normal) : scale_(normal.rows()) {
    for (Eigen::Index i = 0; i < scale_.size(); ++i)
      scale_(i) = normal(i, i) > 0 ? 1 / std::sqrt(normal(i, i)) : 0;
    Eigen::MatrixXd scaled = normal.selfadjointView<Eigen::Lower>();
    scaled = scale_.asDiagonal() * scaled * scale_.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
    values_ = solver.eigenvalues();
    vectors_ = scale_.asDiagonal() * solver.eigenvectors();
  }

  /// The solution of N x = `gradient`, held back by `damping` (Marquardt 1963); none along
  /// directions without information.
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& gradient, double damping) const {
    Eigen::VectorXd along = vectors_.transpose() * gradient;
    for (Eigen::Index i = 0; i < along.size(); ++i)
      along(i) = informed(i) ? along(i) / (values_(i) + damping) : 0;
    return vectors_ * along;
  }

  [[nodiscard]] Eigen::MatrixXd covariance() const {
    Eigen::MatrixXd half = vectors_;
    for (Eigen::Index i = 0; i < half.cols(); ++i)
      half.col(i) *= informed(i) ? 1 / std::sqrt(values_(i)) : 0;
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(half.rows(), half.rows());
    whole.selfadjointView<Eigen::Lower>().rankUpdate(half);
    return whole.selfadjointView<Eigen::Lower>();
  }

  /// Of the scaled-back matrix, over what has information.
  [[nodiscard]] double log_determinant() const {
    double sum = 0;
    for (Eigen::Index i = 0; i < values_.size(); ++i) {
      if (informed(i)) sum += std::log(values_(i));
      if (scale_(i) > 0) sum -= 2 * std::log(scale_(i));
    }
    return sum;
  }

  [[nodiscard]] double condition() const {
    double smallest = values_(values_.size() - 1);
    for (Eigen::Index i = values_.size() - 1; i >= 0 && informed(i); --i) smallest = values_(i);
    return values_(values_.size() - 1) / smallest;
  }

  /// Directions without information. Parameters that nothing depends on are no loss.
  [[nodiscard]] std::size_t undetermined() const {
    std::size_t count = 0;
    for (Eigen::Index i = 0; i < values_.size(); ++i)
      if (!informed(i)) ++count;
    return count - static_cast<std::size_t>((scale_.array() == 0).count());
  }

 private:
  [[nodiscard]] bool informed(Eigen::Index i) const { return values_(i) > kNoInformation; }

  Eigen::VectorXd scale_;
  Eigen::VectorXd values_;   // rising
  Eigen::MatrixXd vectors_;  // columns, scaled back
};

}  // namespace identify
