#pragma once

#include <string>
#include <vector>

#include "identify/clock/angle_tape.hpp"
#include "identify/clock/motion_spans.hpp"

namespace sweepd {

/// What a measuring device saw, beside what the controller told meanwhile. Each by its own clock.
struct DeviceTake {
  identify::AngleTape angles;
  std::vector<identify::Measured> points;  ///< in the order of time, target by target
  std::vector<std::string> targets;        ///< their names in order of appearance
  double step_mm = 0;                      ///< one unit of the last decimal of positions
  std::size_t files = 0;
  /// There is nothing else to identify from: where the clocks do not match, that is an error.
  bool required = false;
};

}  // namespace sweepd
