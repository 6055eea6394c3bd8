#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

namespace identify {

/// Eigenvalues of a normal matrix, scaled to a unit diagonal, below this carry no information.
inline constexpr double kNoInformation = 1e-9;

/// A normal matrix, scaled to a unit diagonal: what it determines, and what not. Which directions
/// these are, its eigenvectors, is found only where someone asks, or where not all are determined.
/// Not to be shared by threads.
class Information {
 public:
  /// `normal`: symmetric, the lower triangle is read.
  explicit Information(const Eigen::MatrixXd& normal);

  /// The solution of N x = `gradient`, held back by `damping` (Marquardt 1963); none along
  /// directions without information.
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& gradient, double damping) const;
  /// Nothing along directions without information.
  [[nodiscard]] Eigen::MatrixXd covariance() const;
  /// The directions with information, one a column, of unit length where the matrix has a unit
  /// diagonal.
  [[nodiscard]] Eigen::MatrixXd determined() const;
  /// What the directions without information add to covariance(): one a column, of parameters that
  /// something depends on; with their transpose it is the rest. Rounding leaves no direction less.
  [[nodiscard]] Eigen::MatrixXd open() const;
  /// The largest eigenvalue with information over the smallest.
  [[nodiscard]] double condition() const;
  /// The logarithm of the determinant. Directions without information count as those with least.
  [[nodiscard]] double log_determinant() const;
  /// Directions without information. Parameters that nothing depends on are no loss.
  [[nodiscard]] std::size_t undetermined() const;

 private:
  struct Directions {
    Eigen::VectorXd values;   // rising
    Eigen::MatrixXd vectors;  // columns, scaled back
    [[nodiscard]] bool informed(Eigen::Index i) const { return values(i) > kNoInformation; }
  };
  const Directions& directions() const;

  Eigen::VectorXd scale_;
  Eigen::MatrixXd scaled_;
  std::optional<Eigen::MatrixXd> inverse_;  // scaled back; where all directions have information
  mutable std::optional<Directions> directions_;
};

}  // namespace identify
