#pragma once

#include <cstddef>
#include <vector>

#include "identify/sweeps/sample.hpp"

namespace identify {

/// Where positions on an arc, in the order of time, turn round: the first sample of each stroke but
/// the first. Sways below two degrees, and what noise could feign, are none. Nothing where the
/// samples lie on no circle, or turn so often that they are in no order.
[[nodiscard]] std::vector<std::size_t> turning_points(const std::vector<Sample>& samples);

}  // namespace identify
