#pragma once

#include <string>

#include "daemon/outcome.hpp"

namespace sweepd {

/// The text of report.txt: what was seen and identified, for a person at a terminal of 80 columns.
[[nodiscard]] std::string report(const Outcome& outcome);

/// "joint 3: sweep of +90.0 deg in 4.60 s, 1150 samples": what a person wants to see as it happens.
[[nodiscard]] std::string sweep_line(const identify::Sweep& sweep);

}  // namespace sweepd
