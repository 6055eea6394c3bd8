#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain_effects.hpp"
#include "identify/chain/chain_nodes.hpp"
#include "identify/chain/chain_residual.hpp"
#include "identify/geometry/symmetric_eigen.hpp"

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

  /// The directions with information, one a column, of unit length where the matrix has a unit
  /// diagonal.
  [[nodiscard]] Eigen::MatrixXd determined() const {
    Eigen::MatrixXd all(vectors_.rows(), vectors_.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < values_.size(); ++i)
      if (informed(i)) all.col(count++) = vectors_.col(i);
    return all.leftCols(count);
  }

  /// What the directions without information add to covariance(): one a column, of parameters that
  /// something depends on; with their transpose it is the rest. Rounding leaves no direction less.
  [[nodiscard]] Eigen::MatrixXd open() const {
    constexpr double kRounding = 1e-14;
    Eigen::MatrixXd all(vectors_.rows(), vectors_.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < values_.size(); ++i) {
      double share = 0;  // of the scaled direction
      for (Eigen::Index k = 0; k < scale_.size(); ++k)
        if (scale_(k) > 0) share += std::pow(vectors_(k, i) / scale_(k), 2);
      if (!informed(i) && share > 0.5)
        all.col(count++) = vectors_.col(i) / std::sqrt(std::max(values_(i), kRounding));
    }
    return all.leftCols(count);
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

/// The normal equations N x = g of one linearisation.
struct NormalEquations {
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;
  double cost = 0;
};

/// The chain's least-squares problem on nodes, `Size` numbers a node: linearised at one chain after
/// the other, with free angles where they fit best. There are those of 3 numbers, the position, and
/// of 6, with the orientation.
template <int Size>
class ChainProblem {
 public:
  /// The weights are those of `chain`, and stay: what is minimised must not move. `shape`: effects
  /// that are zero there get no columns.
  ChainProblem(const Chain& chain, ChainNodes& nodes, const ChainNoise& noise,
               const ChainEffects& shape);

  /// Of the chain's parameters. Behind them, where they are estimated: one a joint for where its
  /// angle is zero, and one a sag.
  [[nodiscard]] static Eigen::Index count(const Chain& chain);
  /// The same with those behind them.
  [[nodiscard]] Eigen::Index count_all(const Chain& chain) const;
  [[nodiscard]] Eigen::Index first_sag(const Chain& chain) const;

  /// The free angles go along to where the last linearisation put them.
  void follow();
  NormalEquations linearised(const Chain& chain);
  /// What is known of each parameter beforehand: one over its variance.
  [[nodiscard]] Eigen::VectorXd prior(const Chain& chain) const;
  /// One a unit: what eliminating the effects needs.
  std::vector<StrokeProducts> products(const Chain& chain);

 private:
  struct Range {
    double from = std::numeric_limits<double>::infinity();
    double to = -std::numeric_limits<double>::infinity();
    /// From -1 to 1.
    [[nodiscard]] double place(double turn) const {
      return to > from ? std::clamp((2 * turn - from - to) / (to - from), -1.0, 1.0) : 0;
    }
  };

  StrokeProducts unit(const Chain& chain, std::size_t u, ChainPose& pose);
  /// The columns of a unit's effects, transposed: one column a row of the model.
  Eigen::MatrixXd effects(const Chain& chain, std::size_t u, ChainPose& pose) const;
  /// The residual at a node, a free angle where it fits best.
  void settle(const Chain& chain, std::size_t i, ChainPose& pose);
  [[nodiscard]] static bool of_another_target(const Chain& chain, Eigen::Index parameter,
                                              std::size_t target);

  using Orders = Eigen::Matrix<double, kFigureOrders + 1, 1>;
  /// Chebyshev polynomials.
  static Orders polynomials(double x);
  /// What a unit depends on: joints that did not turn change nothing.
  std::vector<Eigen::Index> active(const Chain& chain,
                                   const std::vector<std::size_t>& strokes) const;
  [[nodiscard]] bool free(const ChainObservation& seen) const;

  ChainNodes& nodes_;
  const ChainNoise& noise_;
  const ChainEffects& shape_;
  EffectColumns columns_;
  EffectVariances variances_;
  std::vector<typename ChainResidual<Size>::Square> weights_;
  std::vector<double> swept_;  ///< turns of the sweeping joints
  std::vector<Range> ranges_;  // of each group's turns
  Eigen::MatrixXd rows_;       ///< transposed: one column a row of the model
  Eigen::MatrixXd weighted_;
  ChainResidual<Size> residual_;
};

}  // namespace identify
