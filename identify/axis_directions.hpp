#pragma once

#include <optional>
#include <vector>

#include "identify/dh_extraction.hpp"

namespace identify {

/// Without angles or a plan nobody knows which way is positive. Flipping an axis changes signs of
/// b, theta and alpha but not the robot: of all ways to point the axes, this returns the one whose
/// DH table agrees best with `specified`. Of ways that agree equally well, the one with the fewest
/// flips of the outer joints counts.
[[nodiscard]] std::vector<std::optional<Axis>> agreeing_directions(
    const std::vector<std::optional<Axis>>& axes, double size_mm,
    const std::vector<DhRow>& specified);

}  // namespace identify
