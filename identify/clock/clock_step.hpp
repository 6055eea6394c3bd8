#pragma once

#include <optional>

#include "identify/clock/clock_match.hpp"
#include "identify/clock/motion_spans.hpp"

namespace identify {

/// Where a clock was set.
struct ClockStep {
  double at_s = 0;  ///< by the controller's clock
  double by_s = 0;  ///< so much more the device's clock shows from there on
};

/// A device's clock that is set late in a take goes on beyond what the controller told: by `match`,
/// which most motions fit, each saw motions at the same end of the take where the other did not
/// look. Where two of the device's and two of the controller's, or more, fit another offset, the
/// clock was set. A device that was blind at the end, and went on after the controller had ended,
/// saw others.
[[nodiscard]] std::optional<ClockStep> step_beyond(const Motion& device, const Motion& controller,
                                                   const ClockMatch& match);

}  // namespace identify
