#pragma once

#include "daemon/history/history.hpp"
#include "daemon/history/repeatability.hpp"

namespace sweepd {

/// How campaigns of one state scatter, from the best evidence that there is: those that are marked;
/// where these are of one season, and where none are, how campaigns of a year differ; else what
/// differs from one campaign to the next. `history`: its campaigns have values. Sets its basis.
[[nodiscard]] Scatter scatter_of(History& history);

}  // namespace sweepd
