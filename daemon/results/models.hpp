#pragma once

#include <vector>

#include "daemon/results/outcome.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {

/// The arm of an outcome in every form; empty unless its numbers are the chain's and the table is
/// complete.
[[nodiscard]] std::vector<identify::KinematicModel> models_of(const Outcome& outcome);

/// A number as files have it: mm, degrees, or as it is; never -0.
[[nodiscard]] double in_file_units(double value, identify::Quantity quantity);

}  // namespace sweepd
