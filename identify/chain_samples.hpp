#pragma once

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

/// The samples of all sweeps that can be used, joint by joint: those of the circles and, where
/// angles tell where the other joints stood, those from elsewhere than home. Joints without an axis
/// are never turned. More than `kMostObservations` are thinned evenly.
[[nodiscard]] ChainSamples chain_samples(const Identification& circles);

inline constexpr std::size_t kMostObservations = 60'000;

/// The targets at home, near enough to start from: where the circles of each target's sweeps come
/// together. Sets the turns of the sweeping joints by where the samples lie on them.
[[nodiscard]] std::vector<Eigen::Vector3d> starting_targets(
    const Chain& chain, std::vector<ChainObservation>& observations, std::size_t targets,
    bool with_angles);

}  // namespace identify
