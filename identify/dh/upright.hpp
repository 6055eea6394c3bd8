#pragma once

#include <optional>
#include <vector>

#include "identify/dh/dh.hpp"

namespace identify {

/// Which way is up in the frame where an arm's axes were seen at home. `seen`: directions along
/// positive motion, unit, one a joint; nothing where a joint was not seen. `up` is in the base of
/// the specified `arm`, whose rows are at the same home. Axes that differ in direction tell how the
/// one frame is turned against the other; parallel ones tell no more than what lies along them.
/// Nothing where they don't tell it.
[[nodiscard]] std::optional<Eigen::Vector3d> up_among(
    const std::vector<std::optional<Eigen::Vector3d>>& seen, const Arm& arm,
    const Eigen::Vector3d& up);

/// Whether an axis lies along up: about it no weight pulls.
[[nodiscard]] bool is_upright(const Eigen::Vector3d& direction, const Eigen::Vector3d& up);

}  // namespace identify
