#pragma once

#include <optional>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace identify {

/// How far joints may give way about whom nothing is known.
inline constexpr double kMayGive_rad = 30 * kArcsec;

/// What a few poses tell of PoseNoise::weights_rad, a size of random sizes: the root of the
/// standard deviation of its square, by the information that they have of each (of n that are known
/// with the variance v the square's variance is 2 (w^2 + v)^2 / n, the Cramer-Rao bound), at most a
/// tenth of a minute of arc or so.
[[nodiscard]] double weights_unsure_rad(const PoseFit& fit, const std::vector<Pose>& poses,
                                        const std::optional<ChainPrior>& prior);

/// Raises what joints are granted to give way by (rad, one a joint, as Campaign::sag_rad; of none,
/// nothing was) to what poses show. Wheels that are off, of joints that carry weight, count in it:
/// few poses do not tell them from weight. False where what was granted is enough, but for a fifth
/// or a second of arc.
[[nodiscard]] bool grant_sag(const PoseEstimate& found, std::vector<double>& granted_rad);

}  // namespace identify
