#pragma once

#include <string>

#include "daemon/outcome.hpp"

namespace sweepd {

/// The text of dh.csv: a row a joint, for each number identified / standard uncertainty / specified
/// / difference. Empty where something is not known.
[[nodiscard]] std::string dh_csv(const Outcome& outcome);

/// The text of sweeps.csv: a row for each sample that was used, with its distance from the fitted
/// plane and circle.
[[nodiscard]] std::string sweeps_csv(const Outcome& outcome);

}  // namespace sweepd
