#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/results/outcome.hpp"

namespace sweepd {

/// The text of report.txt: what was seen and identified, for a person at a terminal of 80 columns.
[[nodiscard]] std::string report(const Outcome& outcome);

/// "joint 3: sweep of +90.0 deg in 4.60 s, 1150 samples": what a person wants to see as it happens.
/// `planned`: the joint by the plan, counted from 0, for a sweep that does not know its own.
/// `limits`: one a joint, of which the linear ones are told in mm; or none.
[[nodiscard]] std::string sweep_line(const identify::Sweep& sweep,
                                     std::optional<std::size_t> planned = {},
                                     const std::vector<JointLimits>& limits = {});

}  // namespace sweepd
