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
  /// What these effects leave of the sags, what the device does and y: whichever sizes of those are
  /// asked for then, hardly takes time.
  struct Left {
    Eigen::MatrixXd products;  ///< columns: sags, drift, move, and y as it is where all are zero
    double log_determinant = 0;
  };
  [[nodiscard]] Left left_by(const ChainEffects& effects);
  [[nodiscard]] double deviance(const Left& left, const ChainEffects& effects) const;
  /// The shares of the shape's effects and of the noise in the covariance of the fit's parameters:
  /// K V K^T for each cause's V, with K the generalised least-squares estimate's gain.
  [[nodiscard]] std::vector<ChainEstimate::Part> parts();

 private:
  const ChainNodes& nodes_;
  ChainEffects shape_;
  EffectColumns columns_;
  std::optional<EffectElimination> eliminated_;
  Eigen::VectorXd prior_;  ///< of each parameter
  Eigen::VectorXd last_;   ///< the chain's sags, its drift and its move, where the shape has them
  Eigen::VectorXd sag_shares_;
  /// Directions, one a column, that the samples tell of where there is nothing but noise. Effects
  /// leave less of each, but neither take one away nor add one.
  Eigen::MatrixXd determined_;
};

}  // namespace identify
