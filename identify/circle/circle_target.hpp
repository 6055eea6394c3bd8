#pragma once

#include <cstddef>

#include "identify/circle/circle_estimate.hpp"

namespace identify {

/// The target that the circle of a joint with used sweeps is of: the first of them. Where it is so
/// close to the axis that its circle tells none, and another one's does, the one that tells it
/// best.
[[nodiscard]] std::size_t circle_target(const JointResult& joint);

}  // namespace identify
