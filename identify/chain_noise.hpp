#pragma once

#include <vector>

#include "identify/chain.hpp"
#include "identify/chain_estimate.hpp"
#include "identify/chain_residual.hpp"

namespace identify {

/// Variance components of the samples about `chain`, by one step of Fisher scoring from `noise`
/// (restricted maximum likelihood in the form of Rao's MINQUE, J. Multivariate Anal. 1, 1971):
/// position, orientation where asked for, the locked joints' angles together, and each sweeping
/// joint's angle that is not free. None falls below `floor`; what cannot be told apart, or
/// from chance, stays there.
[[nodiscard]] ChainNoise estimate_noise(const Chain& chain,
                                        const std::vector<ChainObservation>& samples,
                                        const ChainNoise& noise, const ChainNoise& floor,
                                        bool with_orientation);

/// Position noise of a fit in which any angle may be free, from the median of the squared
/// distances, of the joint where it is largest: outliers, up to nearly half of each joint's
/// samples, don't change it, and no joint as a whole is an outlier.
[[nodiscard]] double robust_position_sigma(const Chain& chain,
                                           const std::vector<ChainObservation>& samples,
                                           const ChainNoise& noise);

/// Sets the weights: full up to a distance that one good sample in some thousand passes, falling
/// to nothing at twice that (a redescending M-estimator: Hampel et al., Robust Statistics, 1986).
void reweight(const Chain& chain, std::vector<ChainObservation>& samples, const ChainNoise& noise,
              bool with_orientation);

/// Root of the mean squared distance per degree of freedom: 1 where `noise` is right.
[[nodiscard]] double misfit(const Chain& chain, const std::vector<ChainObservation>& samples,
                            const ChainNoise& noise, bool with_orientation);

/// How many successive samples carry as much as one independent one: 1 + 2 sum rho_k, rho_k being
/// the correlation of residuals k samples apart within a stroke; what the fit has taken up of slow
/// changes is put back in proportion. The largest over windows of 1, 2, 4, … lags that cannot be
/// chance (Priestley, Spectral Analysis and Time Series, 1981, ch. 7, on windows): vibration must
/// not hide what is slower. At least 1.
[[nodiscard]] double samples_per_independent(const Chain& chain,
                                             const std::vector<ChainObservation>& samples,
                                             const ChainNoise& noise, bool with_orientation);

}  // namespace identify
