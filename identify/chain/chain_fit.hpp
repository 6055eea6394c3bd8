#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identify/chain/chain.hpp"
#include "identify/chain/chain_effects.hpp"
#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_nodes.hpp"

namespace identify {

/// A weighted least-squares fit of a chain to samples, for given noise.
struct ChainFit {
  Chain chain;
  /// Of the parameters (`ChainParameters`, at `chain`, and behind them its `zero_rad`, `sags`,
  /// `drift_mm` and `move`), for errors independent between samples; zero for what has no
  /// information.
  Eigen::MatrixXd covariance;
  std::vector<ChainEstimate::Part> parts;  ///< of it; nobody has asked yet where it is empty
  Summary summary;
};

/// A way to explain the samples, and how well it does.
struct FittedChain {
  ChainFit fit;
  ChainNoise noise;
};

/// The steady drift that a fit has found, in so many seconds: where it is beyond chance, and beyond
/// what a device that walks at random comes to.
[[nodiscard]] std::optional<ChainEstimate::SteadyDrift> steady_drift_of(const ChainFit& fit,
                                                                        const ChainEffects& effects,
                                                                        double seconds);

/// What a fit moved by less was not moved: no device tells so little.
inline constexpr double kLeastMove_mm = 1e-3;
/// What was moved, as a fit has found it: where the target is moved farthest at home, if that is
/// anything.
[[nodiscard]] std::optional<ChainEstimate::MoveSeen> move_of(const ChainFit& fit,
                                                             const ChainNodes& nodes);

/// How uncertain the drift is that a fit has found: standard deviation of each coordinate, on the
/// average over the campaign.
[[nodiscard]] double drift_sigma_mm(const ChainFit& fit, const ChainEffects& effects);

/// Steps of a fit. One that has made so many has not converged.
inline constexpr int kMostIterations = 50;

/// Gauss-Newton, damped where a step does not help, from `start`, with the random effects
/// eliminated. The joints' free angles (noise infinite) are brought along in `nodes`. Ends when a
/// step is below 1e-7 standard uncertainties, or after `most_iterations`; with none, the covariance
/// and the step that would have been made are those at `start`.
///
/// `with_orientation`: the tool's orientation is data, and its three angles are parameters.
/// Deterministic; one thread. Never throws for what the data hold: directions in parameter space
/// without information stay where they start, are counted, and all that is open in the covariance.
[[nodiscard]] ChainFit fit_chain(const Chain& start, ChainNodes& nodes, const ChainNoise& noise,
                                 const ChainEffects& effects, bool with_orientation,
                                 int most_iterations = kMostIterations);

/// States a fit as axes: sets `chain`, `axes`, `covariance` and `parts` of the estimate, each axis
/// where the first target passes it. `known`, one a joint, tells which axes the fit was about; of
/// these an axis that is uncertain by more than a degree is none. Of the fit's targets the first
/// `targets` count. Reads `with_orientation` of the estimate.
void set_fitted_axes(ChainEstimate& estimate, const ChainFit& fit, const std::vector<bool>& known,
                     std::size_t targets);

}  // namespace identify
