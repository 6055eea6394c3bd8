#pragma once

#include <string>

#include "identify/identification.hpp"

namespace sweepd {

/// The DH table for people: identified, standard uncertainty, the circles' value where the table is
/// the chain's, and the specified table where there is one.
[[nodiscard]] std::string dh_text(const identify::Identification& found);

}  // namespace sweepd
