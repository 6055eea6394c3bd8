#pragma once

#include <optional>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace identify {

/// How far joints may give way of which nothing is known.
inline constexpr double kMayGive_rad = 30 * kArcsec;

/// How much larger PoseNoise::weights_rad may be than the fit has it: the root of the standard
/// deviation of its square, at most 10 arcsec. Of n weights that the poses know with the variance
/// v, the square of their size w has the variance 2 (w^2 + v)^2 / n (the Cramer-Rao bound).
[[nodiscard]] double weights_unsure_rad(const PoseFit& fit, const std::vector<Pose>& poses,
                                        const std::optional<ChainPrior>& prior);

/// Raises what joints are granted to give way by (rad, one a joint, as Campaign::sag_rad; of none,
/// nothing was) to what poses show. Wheels that are off, of joints that carry weight, count in it:
/// few poses do not tell them from weight. False where what was granted is enough, but for a fifth
/// or a second of arc.
[[nodiscard]] bool grant_sag(const PoseEstimate& found, std::vector<double>& granted_rad);

}  // namespace identify
