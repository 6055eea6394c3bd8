#pragma once

#include <cstddef>
#include <list>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_nodes.hpp"

namespace identify {

/// One stroke's share in the normal equations: the weighted sums of products of all columns that it
/// knows, C^T W C with C = (own, stand's, shared, home's, parameters, y). Random effects are
/// nested: a stroke belongs to one stand, whose strokes share effects, a stand to one group, and a
/// group to one home, likewise.
struct StrokeProducts {
  Eigen::MatrixXd products;              ///< square, symmetric
  std::size_t stand = 0;                 ///< one stroke after the other, in any order
  std::vector<Eigen::Index> parameters;  ///< which of all parameters its columns are
};

/// Variances of the random effects, in the order of the columns; an effect of size 0 does nothing.
struct EffectVariances {
  std::vector<Eigen::VectorXd> own;     ///< one a stroke
  std::vector<Eigen::VectorXd> stand;   ///< one a stand
  std::vector<Eigen::VectorXd> shared;  ///< one a group
  std::vector<Eigen::VectorXd> home;    ///< one a home
};

/// The mixed model y = X b + Z u + e, u ~ N(0, D) with D diagonal and known, e weighed: the normal
/// equations of b with u eliminated (Henderson 1975, Biometrics 31, eq. 3), which are those of
/// generalised least squares with the covariance V = Z D Z^T + W^-1.
struct Eliminated {
  Eigen::MatrixXd normal;      ///< of the parameters
  Eigen::VectorXd gradient;    ///< its right side
  double squares = 0;          ///< y^T V^-1 y, before b is fitted
  double log_determinant = 0;  ///< of V, but for that of the weights: log |I + D Z^T W Z|
};
/// Takes the first columns, effects with these variances, out of products; what is left is of the
/// other columns. Adds to the logarithm of V's determinant.
[[nodiscard]] Eigen::MatrixXd without_effects(const Eigen::MatrixXd& products,
                                              const Eigen::VectorXd& variances,
                                              double& log_determinant);

/// Takes all effects out of strokes' products. Where the next variances differ only in the outer
/// levels, what was found of the inner ones stands.
class EffectElimination {
 public:
  /// `group_of`: of each stand; `home_of`: of each group.
  EffectElimination(std::vector<StrokeProducts> strokes, std::vector<std::size_t> group_of,
                    std::vector<std::size_t> home_of, Eigen::Index parameters);
  [[nodiscard]] Eliminated operator()(const EffectVariances& variances);

 private:
  /// What is left once the effects of one level, with these variances, are out.
  struct Level {
    std::vector<Eigen::VectorXd> variances;
    std::vector<Eigen::MatrixXd> left;
    double log_determinant = 0;
  };

  /// A search for sizes comes back to what it has just left. So many matrices are kept for it.
  static constexpr std::size_t kKept = 200;

  void use_own(const EffectVariances& variances);

  std::vector<StrokeProducts> strokes_;
  std::vector<std::size_t> group_of_;
  std::vector<std::size_t> home_of_;
  Eigen::Index parameters_;
  std::list<Level> own_;  ///< left: one a stand; the last used first
  Level stand_;           ///< left: one a group
  Level shared_;          ///< left: one a home
};

/// Orders of a figure, from the first on, and of what angles are off by, from none on.
inline constexpr Eigen::Index kFigureOrders = 8;

/// The columns that a problem has: of effects that are zero in `shape` none. A unit's own are a
/// turn of each joint, of the sweeping one where rounding shifts its angle, three shifts, and three
/// that grow from minus one at a stroke's least turn to one at its greatest. Where printed
/// orientations are shifted, so many follow, of A, B, C, and three that bend, as the second
/// Legendre polynomial of the stroke's turn. Where rounding bends a stroke, and where a joint has
/// swept again, so that a device that wanders can be told from homes that are off, three shifts do
/// so, too. A stand's are a turn of each joint, where homes stay. Those of a group are the orders
/// of each target's radial and then axial figure, behind them three shifts where several units
/// share a device that wanders, and those of the joint's angle. A home's are a turn of each joint.
struct EffectColumns {
  EffectColumns(const ChainEffects& shape, const ChainNodes& nodes);
  Eigen::Index own = 0;
  Eigen::Index turned = 0;  ///< of these, those of A, B, C
  Eigen::Index bent = 0;    ///< and the last ones
  bool drift_bends = false;
  Eigen::Index stand = 0;
  Eigen::Index figure = 0;  ///< of one target
  Eigen::Index wander = 0;
  std::vector<double> in_common;  ///< which share of a wandering device's shifts; one a group
  Eigen::Index told = 0;
  Eigen::Index home = 0;
  std::size_t targets = 0;
  [[nodiscard]] Eigen::Index shared() const {
    return figure * static_cast<Eigen::Index>(targets) + wander + told;
  }
};

/// How the target moves with a unit's own effects, one a row, at a node: `by_turn` are the columns
/// of the Jacobian, `place` is from minus one at the stroke's least turn to one at its greatest.
template <int Size, class ByTurn>
[[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, Size> own_effects(
    const EffectColumns& columns, const ByTurn& by_turn, const std::vector<bool>& known,
    const ChainObservation& seen, double place) {
  const auto turns = static_cast<Eigen::Index>(known.size());
  Eigen::Matrix<double, Eigen::Dynamic, Size> rows =
      Eigen::Matrix<double, Eigen::Dynamic, Size>::Zero(columns.own, Size);
  for (std::size_t k = 0; k < known.size(); ++k)
    if (known[k])
      rows.row(static_cast<Eigen::Index>(k)) = by_turn[k].template head<Size>().transpose();
  const double bend = 1.5 * place * place - 0.5;
  rows.template block<3, 3>(turns, 0).setIdentity();
  rows.template block<3, 3>(turns + 3, 0).diagonal().setConstant(place);
  if constexpr (Size == 6)
    if (columns.turned > 0) {
      const Eigen::Matrix3d axes = abc_axes(seen.orientation).transpose();
      rows.template block<3, 3>(turns + 6, 3) = axes;
      rows.template block<3, 3>(turns + 9, 3) = place * axes;
      rows.template block<3, 3>(turns + 12, 3) = bend * axes;
    }
  if (columns.bent > 0) rows.template block<3, 3>(columns.own - 3, 0).diagonal().setConstant(bend);
  return rows;
}

/// The variances of these columns for `effects` at most those of the shape. A device that wanders
/// has gone less far between two strokes the sooner one follows the other: a group's have so much
/// of their shifts in common. Without columns for that, each stroke has its own.
[[nodiscard]] EffectVariances variances_of(const ChainEffects& effects, const ChainNodes& nodes,
                                           const EffectColumns& columns);

/// What is moved by as much as the target turns by so much at this distance: of all that is moved a
/// joint of the wrist that stands off home turns most.
inline constexpr double kMoveLever_mm = 250;

/// Standard deviations of the chain's drift and the move, as `effects` size them: one a
/// column that the shape has.
[[nodiscard]] Eigen::VectorXd device_sigmas(const ChainEffects& shape, const ChainEffects& effects,
                                            Eigen::Index move_numbers);

}  // namespace identify
