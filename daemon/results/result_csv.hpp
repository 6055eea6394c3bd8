#pragma once

#include <string>

#include "daemon/results/outcome.hpp"

namespace sweepd {

/// The text of dh.csv: a row a joint, for each number identified / standard uncertainty / specified
/// / difference, and the 95 % interval's ends; `positive` is 1 where Z is along positive rotation,
/// -1 where against it; theta is the angle at `home_deg`. Empty where something is not known.
[[nodiscard]] std::string dh_csv(const Outcome& outcome);

/// The text of sweeps.csv: a row for each sample that was used, with its distances from the fitted
/// plane and circle (empty for a sweep from elsewhere than home), and from where the chain has it.
/// `target` counts from 1.
[[nodiscard]] std::string sweeps_csv(const Outcome& outcome);

/// The text of poses.csv: a row for each static pose, as it was given, with where it was seen less
/// where the fit has it, and the size of that in standard deviations of the noise.
[[nodiscard]] std::string poses_csv(const Outcome& outcome);

}  // namespace sweepd
