#pragma once

#include <optional>
#include <vector>

#include "identify/chain/angle_track.hpp"
#include "identify/chain/delay.hpp"

namespace identify {

/// The delay that makes the told angles of all strokes follow the seen ones best, by least squares:
/// beside a smooth error and a backlash of each group, and of each stroke what its locked joints
/// make of it. `tracks`: one or more, by group. `two_clocks`: angles are off by the jitter of
/// stamps, the faster the more, and the delay grows. Nothing where it is not determined.
[[nodiscard]] std::optional<Delay> fitted_delay(const std::vector<AngleTrack>& tracks,
                                                bool two_clocks);

}  // namespace identify
