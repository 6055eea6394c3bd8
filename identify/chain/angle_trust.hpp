#pragma once

#include <vector>

#include "identify/chain/chain.hpp"
#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_nodes.hpp"

namespace identify {

/// The error of a joint's angles as a fit with free angles shows it: one a joint, `trust` smooth or
/// free. `quantum` is what the printed numbers alone would scatter. What strokes have for
/// themselves, as their locked joints stood elsewhere (`effects`), is no error of the angles.
[[nodiscard]] std::vector<AngleEvidence> seen_angle_errors(const Chain& chain,
                                                           const ChainNodes& nodes,
                                                           const ChainNoise& noise,
                                                           const ChainNoise& quantum,
                                                           const ChainEffects& effects);

/// Sets `size` and `coherence` of every joint whose angles are believed in this fit.
void test_believed_angles(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise,
                          const ChainNoise& quantum, std::vector<AngleEvidence>& evidence);

/// Whether angles that were believed stand the test: small, and without a pattern.
[[nodiscard]] bool stands_test(const AngleEvidence& evidence);

/// Residuals up to this many standard deviations of the print quantum are explained by it.
inline constexpr double kMostQuanta = 3;

}  // namespace identify
