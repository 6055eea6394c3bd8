#pragma once

#include <string>

#include "identify/identification.hpp"

namespace sweepd {

/// What the uncertainties of the table come from, for people; empty where the chain found nothing.
[[nodiscard]] std::string budget_text(const identify::Identification& found);

}  // namespace sweepd
