#pragma once

#include <vector>

#include "identify/dh/dh_extraction.hpp"
#include "tests/simulation/simulation.hpp"

namespace simulation {

/// The numbers that `found` ought to have: the true table at the home of the result, in its own
/// form. Rows that it calls parallel or coincident have b as specified and a beta, others have
/// beta = 0; the first frame lies as identify::first_frame has it; common normals point as the
/// specified arm's. Worked out from the definition, apart from identify/dh/dh_extraction.cpp.
/// `home_rad`: the home of the result, where it has one; else that which was meant.
[[nodiscard]] std::vector<identify::DhRow> true_table(
    const Simulation& simulation, const std::vector<identify::DhEstimate>& found,
    const std::vector<std::optional<double>>& home_rad);

/// Of all numbers that are identified, in standard uncertainties.
[[nodiscard]] std::vector<double> errors_in_sigmas(const Simulation& simulation,
                                                   const identify::Identification& found);

}  // namespace simulation
