#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain_residual.hpp"
#include "identify/circle/circle_estimate.hpp"
#include "identify/sweeps/stroke_moments.hpp"

namespace identify {

/// Below it no angle is measured, and none computed in double precision.
inline constexpr double kLeastAngle_rad = 1e-11;

/// What the chain estimator works on: the strokes' moments, and of each node the mean of its
/// samples as if it were one, with their number as its weight. To first order in the scatter within
/// a stroke, least squares over these is least squares over all samples.
struct ChainNodes {
  std::vector<StrokeMoments> strokes;
  std::vector<ChainObservation> observations;  ///< stroke by stroke, in the order of their nodes
  std::vector<std::size_t> first;              ///< of each stroke, among the observations
  std::vector<bool> known;                     ///< which joints are in the chain
  std::size_t targets = 0;
  bool with_angles = false;       ///< of all joints, at every sample
  bool with_orientation = false;  ///< at every sample

  /// Strokes of one joint that were seen at once, of one target each, are a unit; units of the same
  /// joint and home are a group. Those of a group that follow each other, while no other joint
  /// swept, are a stand: the locked joints may have stood still all the while.
  std::vector<std::vector<std::size_t>> units;  ///< of strokes
  std::vector<std::size_t> group;               ///< of each unit
  std::vector<std::size_t> stand;               ///< of each unit
  std::vector<std::size_t> group_of;            ///< of each stand
  std::vector<std::size_t> home_of;             ///< of each group
  /// A joint rests from one of its sweeps to its next one, or until all go to another home. Whose
  /// each rest at a home is; none where nothing tells which unit follows which.
  std::vector<std::vector<std::size_t>> rests;
  /// Of each unit, which of its home's rests each joint is in; the sweeping one, and those that are
  /// not `known`, in none.
  std::vector<std::array<std::optional<std::size_t>, kMostJoints>> rest_of;
  /// Where the joints stood at each home, from the first one; of a joint that was never seen locked
  /// there, zero. The first is the common one.
  std::vector<Turns> homes;
  bool timed =
      false;  ///< units follow each other on one clock, and `times` of observations are set

  [[nodiscard]] bool all_known() const {
    return std::find(known.begin(), known.end(), false) == known.end();
  }
  [[nodiscard]] std::size_t samples() const;
  [[nodiscard]] std::size_t outliers() const;
  /// Of the circle that the unit's first stroke runs on.
  [[nodiscard]] const Eigen::Vector3d& middle_mm(std::size_t unit) const {
    return strokes[units[unit].front()].circle.center_mm;
  }
  [[nodiscard]] double begin_s(std::size_t unit) const {
    return strokes[units[unit].front()].begin_s;
  }
  /// The units in the order of time.
  [[nodiscard]] std::vector<std::size_t> in_time() const;
  /// Something was moved before this unit, or while it ran: after a part of its time.
  void set_move(std::size_t unit, double part = 0);
  /// From the first sample of all strokes to the last one.
  [[nodiscard]] double seconds() const;
  /// The number of rests at a home, at most.
  [[nodiscard]] std::size_t most_rests() const;
  /// Whether a stand has several units.
  [[nodiscard]] bool stays() const { return group_of.size() < units.size(); }
  /// Whether a joint has swept more than once, wherever from.
  [[nodiscard]] bool sweeps_again() const;
};

/// `home_rad`: one a joint; where it has none, and for joints that are not `known`, turns are zero.
[[nodiscard]] ChainNodes nodes_of(std::vector<StrokeMoments> strokes,
                                  const std::vector<std::optional<double>>& home_rad,
                                  std::vector<bool> known);

/// The strokes of all joints with an axis to start from, joint by joint: those of the circles and,
/// where angles tell where the other joints stood, those from elsewhere than home. The other joints
/// are never turned. `printed`: the steps of what was told.
[[nodiscard]] ChainNodes chain_nodes(const CircleEstimate& circles,
                                     const std::vector<std::optional<ChainAxis>>& axes,
                                     const Resolution& printed);

/// What a node's samples scatter by about it, and what its mean is off by.
template <int Size>
struct NodeScatter {
  using Square = typename ChainResidual<Size>::Square;
  using Vector = typename ChainResidual<Size>::Vector;
  ChainResidual<Size> residual;
  Square within = Square::Zero();  ///< sum of squares about the mean
  Square by_locked = Square::Zero();
  double samples = 0;
};

/// Rotates the measurement frame's vectors, positions and rotations, into the stroke's directions.
template <int Size>
Eigen::Matrix<double, Size, Size> turned_to(const Eigen::Matrix3d& directions) {
  Eigen::Matrix<double, Size, Size> turned = Eigen::Matrix<double, Size, Size>::Zero();
  turned.template topLeftCorner<3, 3>() = directions;
  if constexpr (Size == 6) turned.template bottomRightCorner<3, 3>() = directions;
  return turned;
}

/// Calls `see` with each stroke and its nodes' scatter; of strokes without squares nothing is known
/// of it.
template <int Size, class See>
void visit_nodes(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise,
                 const See& see) {
  ChainPose pose(chain);
  std::vector<NodeScatter<Size>> scatter;
  for (std::size_t s = 0; s < nodes.strokes.size(); ++s) {
    const StrokeMoments& stroke = nodes.strokes[s];
    if (!stroke.squares) continue;
    scatter.assign(stroke.nodes.size(), {});
    const Eigen::Index errors = stroke.content.orientation ? 6 : 3;
    const auto wobbles = static_cast<Eigen::Index>(stroke.content.joints);
    for (std::size_t n = 0; n < stroke.nodes.size(); ++n) {
      const ChainObservation& seen = nodes.observations[nodes.first[s] + n];
      pose.set(seen.target, turns_of(chain, seen, noise), false);
      NodeScatter<Size>& at = scatter[n];
      at.residual.set(chain, seen, pose, noise);
      at.samples = seen.weight;
      for (std::size_t k = 0; k < chain.axes.size(); ++k)
        if (k != seen.joint)
          at.by_locked.noalias() += pose.by_turn[k].template head<Size>() *
                                    pose.by_turn[k].template head<Size>().transpose();
      // e - sum_k J_k v_k, all in the measurement frame.
      const auto back =
          turned_to<Size>(stroke.directions(stroke.nodes[n].turn_rad)).transpose().eval();
      constexpr int kMost = 6 + static_cast<int>(kMostJoints);
      Eigen::Matrix<double, Size, Eigen::Dynamic, 0, Size, kMost> combined =
          decltype(combined)::Zero(Size, errors + wobbles);
      combined.template leftCols<Size>() = back;
      for (Eigen::Index k = 0; k < wobbles; ++k)
        if (static_cast<std::size_t>(k) != seen.joint && nodes.known[static_cast<std::size_t>(k)])
          combined.col(errors + k) =
              -pose.by_turn[static_cast<std::size_t>(k)].template head<Size>();
      const auto& sums = stroke.nodes[n].sums;
      const Eigen::Index rest = sums.rows() - 1;
      decltype(combined) weighted(Size, rest);
      weighted.noalias() = combined.lazyProduct(sums.bottomRightCorner(rest, rest));
      const typename NodeScatter<Size>::Vector sum =
          combined.lazyProduct(sums.bottomLeftCorner(rest, 1));
      at.within.noalias() = weighted.lazyProduct(combined.transpose());
      if (at.samples != 0) at.within.noalias() -= sum * sum.transpose() / at.samples;
    }
    see(s, scatter);
  }
}

}  // namespace identify
