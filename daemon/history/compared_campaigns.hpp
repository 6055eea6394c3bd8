#pragma once

#include <string>
#include <vector>

#include "daemon/history/history.hpp"
#include "daemon/history/repeatability.hpp"

namespace sweepd {

/// Sets all of a history that comes from comparing campaigns, in the order of time, with the one at
/// `reference`. `states`: as which they are marked, one each.
void compare_campaigns(std::vector<CampaignRecord> records, const std::vector<std::string>& states,
                       std::size_t reference, const HistoryOptions& options, History& history);

/// How campaigns of one state scatter, from the best evidence that there is: those that are marked;
/// where these are of one season, and where none are, how campaigns of a year differ; else what
/// differs from one campaign to the next. `history`: its campaigns have values. Sets its basis.
[[nodiscard]] Scatter scatter_of(History& history);

}  // namespace sweepd
