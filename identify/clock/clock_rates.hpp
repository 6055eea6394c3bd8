#pragma once

#include "identify/clock/clock_match.hpp"

namespace identify {

/// As `match_clocks`, where a device's times were made with a wrong frame rate, as of 119.88 frames
/// a second that were taken for 120: any rate within 0.3 % that no clock is off by. Each way to
/// match has that rate. No problem is told: what `match_clocks` found against usual clocks says
/// more.
[[nodiscard]] ClockSearch match_wrong_rate(const Motion& device, const Motion& controller);

}  // namespace identify
