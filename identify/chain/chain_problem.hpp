#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain_effects.hpp"
#include "identify/chain/chain_nodes.hpp"
#include "identify/chain/chain_residual.hpp"

namespace identify {

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
  /// angle is zero, one a sag, three a part of the drift, and those of the move.
  [[nodiscard]] static Eigen::Index count(const Chain& chain);
  /// The same with those behind them.
  [[nodiscard]] Eigen::Index count_all(const Chain& chain) const;
  [[nodiscard]] Eigen::Index first_sag(const Chain& chain) const;
  [[nodiscard]] Eigen::Index first_drift(const Chain& chain) const;
  [[nodiscard]] Eigen::Index first_move(const Chain& chain) const;

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
  /// One of a home's effects, which turns this joint.
  struct HomeColumn {
    Eigen::Index at = 0;
    std::size_t joint = 0;
  };
  /// Those that the unit knows, ascending.
  [[nodiscard]] std::vector<HomeColumn> home_columns(std::size_t u) const;
  using EffectRows = Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Size>>;
  /// The columns of a unit's effects, but for its home's, at a node of its stroke, transposed. They
  /// are zero before.
  void set_effects(std::size_t u, const StrokeMoments& stroke, std::size_t n,
                   const ChainObservation& seen, const ChainPose& pose, EffectRows rows) const;
  /// The residual at a node, a free angle where it fits best. `pose` is that of the node.
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
