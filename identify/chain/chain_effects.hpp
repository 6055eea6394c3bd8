#pragma once

#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_nodes.hpp"
#include "identify/chain/effect_elimination.hpp"

namespace identify {

/// Orders of a figure, from the first on, and of what angles are off by, from none on.
inline constexpr Eigen::Index kFigureOrders = 8;

/// The columns that a problem has; of effects that are zero in `shape` none.
///
/// A unit's own, one behind the other:
///   - a turn of each joint; of the sweeping one where rounding shifts its angle;
///   - three shifts of the target, and three that grow from minus one at the stroke's least turn to
///     one at its greatest;
///   - `turned`: as many of A, B, C, and three that bend as the second Legendre polynomial of the
///     turn, where printed orientations are shifted;
///   - `swept`: the sweeping joint's angle grows and bends, where rounding shifts it;
///   - `carried`: what joints of which no axis is known carry turns as one body; as far as it is
///     behind the sweeping joint, it is shifted and turned on that;
///   - `creep`: a turn of each joint that goes on;
///   - `bent`: three shifts that bend, where rounding bends a stroke, or where a joint has swept
///     again, so that a device that wanders can be told from homes that are off.
///
/// A stand's: a turn of each joint, where homes stay.
///
/// A group's: of each target the orders of its radial and then of its axial `figure`; `wander`,
/// three shifts where several units share a device that wanders; `told`, the orders of the joint's
/// angle.
///
/// A home's: `offset`, a turn of each joint, and `rest`, one for each rest through which joints
/// stand off home alike.
struct EffectColumns {
  EffectColumns(const ChainEffects& shape, const ChainNodes& nodes);
  Eigen::Index own = 0;
  Eigen::Index turned = 0;   ///< of these, those of A, B, C
  Eigen::Index swept = 0;    ///< those behind them of the sweeping joint's angle
  Eigen::Index carried = 0;  ///< behind those, what joints of which no axis is known carry
  Eigen::Index creep = 0;    ///< of joints that go on
  Eigen::Index bent = 0;     ///< and the last ones
  bool drift_bends = false;
  Eigen::Index stand = 0;
  Eigen::Index figure = 0;  ///< of one target
  Eigen::Index wander = 0;
  std::vector<double> in_common;  ///< which share of a wandering device's shifts; one a group
  Eigen::Index told = 0;
  Eigen::Index offset = 0;
  Eigen::Index rest = 0;
  std::size_t targets = 0;
  [[nodiscard]] Eigen::Index creeps() const { return own - bent - creep; }  ///< the first of them
  [[nodiscard]] Eigen::Index carries() const { return creeps() - carried; }
  [[nodiscard]] Eigen::Index shared() const {
    return figure * static_cast<Eigen::Index>(targets) + wander + told;
  }
  [[nodiscard]] Eigen::Index home() const { return offset + rest; }
};

/// How the target moves with a unit's own effects, one a row, at a node: `pose` is the chain's
/// there, `place` is from minus one at the stroke's least turn to one at its greatest, `middle_mm`
/// is the same for all nodes of the unit.
template <int Size>
[[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, Size> own_effects(
    const EffectColumns& columns, const ChainPose& pose, const std::vector<bool>& known,
    const ChainObservation& seen, double place, const Eigen::Vector3d& middle_mm) {
  const auto turns = static_cast<Eigen::Index>(known.size());
  Eigen::Matrix<double, Eigen::Dynamic, Size> rows =
      Eigen::Matrix<double, Eigen::Dynamic, Size>::Zero(columns.own, Size);
  for (std::size_t k = 0; k < known.size(); ++k)
    if (known[k])
      rows.row(static_cast<Eigen::Index>(k)) = pose.by_turn[k].template head<Size>().transpose();
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
  if (columns.swept > 0) {
    const auto by_swept = pose.by_turn[seen.joint].template head<Size>().transpose();
    rows.row(turns + 6 + columns.turned) = place * by_swept;
    rows.row(turns + 7 + columns.turned) = bend * by_swept;
  }
  if (columns.carried > 0) {
    // As one body about the middle; and behind the sweeping joint, turned as it has turned.
    const Eigen::Index at = columns.carries();
    for (Eigen::Index i = 0; i < 3; ++i)
      rows.template block<1, 3>(at + i, 0) =
          Eigen::Vector3d::Unit(i).cross(pose.position_mm - middle_mm).transpose();
    rows.template block<3, 3>(at + 3, 0) = pose.rotation.transpose();
    if constexpr (Size == 6) {
      rows.template block<3, 3>(at, 3).setIdentity();
      rows.template block<3, 3>(at + 6, 3) = pose.rotation.transpose();
    }
  }
  for (Eigen::Index k = 0; k < columns.creep; ++k)
    rows.row(columns.creeps() + k) = place * rows.row(k);
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
