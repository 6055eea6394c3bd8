#pragma once

#include <optional>
#include <vector>

#include "identify/chain_residual.hpp"
#include "identify/identification.hpp"

namespace identify {

/// What the chain estimator works on.
struct ChainSamples {
  std::vector<ChainObservation> observations;
  std::size_t targets = 0;
  bool with_angles = false;       ///< of all joints, at every sample
  bool with_orientation = false;  ///< at every sample
};

/// An axis for each joint to start from, by a robust circle of the sweeps that the circles used;
/// it points as the circle's does. Nothing where there is no circle, or hardly one: direction
/// uncertain by more than a degree.
[[nodiscard]] std::vector<std::optional<ChainAxis>> starting_axes(const Identification& circles);

/// The samples of all sweeps of joints with an axis to start from, joint by joint: those of the
/// circles and, where angles tell where the other joints stood, those from elsewhere than home. The
/// other joints are never turned. More than `kMostObservations` are thinned evenly.
[[nodiscard]] ChainSamples chain_samples(const Identification& circles,
                                         const std::vector<std::optional<ChainAxis>>& axes);

inline constexpr std::size_t kMostObservations = 60'000;

/// The targets at home, near enough to start from: where the circles of each target's sweeps come
/// together. Sets the turns of the sweeping joints by where the samples lie on them.
[[nodiscard]] std::vector<Eigen::Vector3d> starting_targets(
    const Chain& chain, std::vector<ChainObservation>& observations, std::size_t targets,
    bool with_angles);

}  // namespace identify
