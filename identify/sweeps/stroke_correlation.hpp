#pragma once

#include <vector>

#include "identify/sweeps/stroke_moments.hpp"

namespace identify {

/// How many successive samples of these strokes are worth one independent one: 1 + 2 sum rho_k,
/// with rho_k the correlation of errors k samples apart. The block sums of all strokes together are
/// compared with those of white noise plus an autoregression of the first order, from which the
/// stroke's own curve was taken out. Where they are those of white noise within three standard
/// deviations it is 1.
[[nodiscard]] double correlation_of(const std::vector<StrokeMoments>& strokes);

}  // namespace identify
