#pragma once

#include <vector>

#include "identify/chain/chain.hpp"
#include "identify/chain/chain_effects.hpp"
#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_nodes.hpp"

namespace identify {

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
  Eigen::VectorXd sags_;   ///< the chain's: the last of them
};

/// How large those of the chain's random effects are that `shape` has, by restricted likelihood at
/// a linearisation: the mean square of each over all combinations of sizes that the data allow,
/// weighed by their likelihood, so that what the data cannot tell from zero, or from another
/// effect, is not taken for zero. `smallest_mm`, `reach_mm`: what is still seen of a stroke's mean
/// place, and how far the target is from the axes.
[[nodiscard]] ChainEffects effect_sizes(const LinearisedChain& chain, const ChainEffects& shape,
                                        double smallest_mm, double reach_mm);

}  // namespace identify
