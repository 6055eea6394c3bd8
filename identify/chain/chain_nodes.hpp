#pragma once

#include <optional>
#include <vector>

#include "identify/chain/chain_residual.hpp"
#include "identify/circle/circle_estimate.hpp"
#include "identify/sweeps/stroke_moments.hpp"

namespace identify {

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
  /// joint and home are a group.
  std::vector<std::vector<std::size_t>> units;  ///< of strokes
  std::vector<std::size_t> group;               ///< of each unit
  std::vector<std::size_t> home_of;             ///< of each group
  /// Where the joints stood at each home, from the first one; of a joint that was never seen locked
  /// there, zero. The first is the common one.
  std::vector<Turns> homes;

  [[nodiscard]] std::size_t samples() const;
  [[nodiscard]] std::size_t outliers() const;
};

/// `home_rad`: one a joint; where it has none, and for joints that are not `known`, turns are zero.
[[nodiscard]] ChainNodes nodes_of(std::vector<StrokeMoments> strokes,
                                  const std::vector<std::optional<double>>& home_rad,
                                  std::vector<bool> known);

/// The strokes of all joints with an axis to start from, joint by joint: those of the circles and,
/// where angles tell where the other joints stood, those from elsewhere than home. The other joints
/// are never turned.
[[nodiscard]] ChainNodes chain_nodes(const CircleEstimate& circles,
                                     const std::vector<std::optional<ChainAxis>>& axes);

}  // namespace identify
