#pragma once

#include <vector>

#include "identify/chain.hpp"
#include "identify/chain_effects.hpp"
#include "identify/chain_estimate.hpp"
#include "identify/chain_nodes.hpp"

namespace identify {

/// A weighted least-squares fit of a chain to samples, for given noise.
struct ChainFit {
  Chain chain;
  /// Of the parameters (`ChainParameters`, at `chain`, and behind them its `zero_rad`), for errors
  /// independent between samples; zero for what has no information.
  Eigen::MatrixXd covariance;
  std::vector<ChainEstimate::Part> parts;  ///< of it; nobody has asked yet where it is empty
  Summary summary;
};

inline constexpr int kMostIterations = 50;

/// Gauss-Newton, damped where a step does not help, from `start`, with the random effects
/// eliminated. The joints' free angles (noise infinite) are brought along in `nodes`. Ends when a
/// step is below 1e-7 standard uncertainties, or after `most_iterations`; with none, the covariance
/// and the step that would have been made are those at `start`.
///
/// `with_orientation`: the tool's orientation is data, and its three angles are parameters.
/// Deterministic; one thread. Never throws for what the data hold: directions in parameter space
/// without information stay where they start, and are counted.
[[nodiscard]] ChainFit fit_chain(const Chain& start, ChainNodes& nodes, const ChainNoise& noise,
                                 const ChainEffects& effects, bool with_orientation,
                                 int most_iterations = kMostIterations);

/// The model linearised at `chain`: other effects' restricted likelihood, and what each cause has
/// of the covariance, need no other pass over the nodes.
class LinearisedChain {
 public:
  LinearisedChain(const Chain& chain, ChainNodes& nodes, const ChainNoise& noise,
                  const ChainEffects& shape, bool with_orientation);
  /// Minus twice the logarithm of the restricted likelihood (Patterson & Thompson 1971), but for a
  /// constant. `effects` as large or zero as the shape's allow.
  [[nodiscard]] double deviance(const ChainEffects& effects) const;
  /// The shares of the shape's effects and of the noise in the covariance of the fit's parameters:
  /// K V K^T for each cause's V, with K the generalised least-squares estimate's gain.
  [[nodiscard]] std::vector<ChainEstimate::Part> parts() const;

 private:
  const ChainNodes& nodes_;
  ChainEffects shape_;
  EffectColumns columns_;
  std::vector<StrokeProducts> strokes_;
  Eigen::VectorXd prior_;  ///< of each parameter
};

}  // namespace identify
