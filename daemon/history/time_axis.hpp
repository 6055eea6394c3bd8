#pragma once

#include <string>
#include <utility>
#include <vector>

#include "daemon/drawing/plot.hpp"

namespace sweepd {

/// Of some years, months, days or times of day: places on an axis in years since the Unix epoch,
/// with their names: 2024, 2024-03, 03-15, 13:30.
[[nodiscard]] std::vector<std::pair<double, std::string>> date_ticks(const Range& years,
                                                                     std::size_t about);

/// A plot over time, with dates below. `y`: as Plot has it.
[[nodiscard]] Plot plot_over_time(Picture& picture, const Frame& frame, const Range& years,
                                  const Plot::Axis& y, std::size_t ticks);

}  // namespace sweepd
