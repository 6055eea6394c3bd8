#pragma once

#include <optional>
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
  [[nodiscard]] double deviance(const ChainEffects& effects);
  /// The same of these effects with each of these sizes of sag, which takes hardly longer.
  [[nodiscard]] std::vector<double> deviances(const ChainEffects& effects,
                                              const std::vector<double>& sags_rad);
  /// The shares of the shape's effects and of the noise in the covariance of the fit's parameters:
  /// K V K^T for each cause's V, with K the generalised least-squares estimate's gain.
  [[nodiscard]] std::vector<ChainEstimate::Part> parts();

 private:
  /// Columns: the sags, the other parameters, and y as it is where nothing sags.
  [[nodiscard]] Eigen::MatrixXd sags_first(const Eliminated& all) const;

  const ChainNodes& nodes_;
  ChainEffects shape_;
  EffectColumns columns_;
  std::optional<EffectElimination> eliminated_;
  Eigen::VectorXd prior_;  ///< of each parameter
  Eigen::VectorXd sags_;   ///< the chain's: the last of them
  Eigen::VectorXd sag_shares_;
  /// Directions, one a column, that the samples tell of where there is nothing but noise. Effects
  /// leave less of each, but neither take one away nor add one.
  Eigen::MatrixXd determined_;
};

}  // namespace identify
