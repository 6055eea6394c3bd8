#pragma once

#include <string>

#include "daemon/results/outcome.hpp"

namespace sweepd {

/// dh.tex: the DH table as a `tabular` that a paper can \input; needs the package booktabs.
/// Identified numbers with the half-width of their 95 % interval to two digits, specified ones and
/// the difference where there is a specified table; a dagger marks what convention sets. beta has a
/// row where axes are parallel or coincident.
[[nodiscard]] std::string dh_latex(const Outcome& outcome);

}  // namespace sweepd
