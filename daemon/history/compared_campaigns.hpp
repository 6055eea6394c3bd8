#pragma once

#include <string>
#include <vector>

#include "daemon/history/history.hpp"

namespace sweepd {

/// Sets all of a history that comes from comparing campaigns, in the order of time, with the one at
/// `reference`. `states`: as which they are marked, one each.
void compare_campaigns(std::vector<CampaignRecord> records, const std::vector<std::string>& states,
                       std::size_t reference, const HistoryOptions& options, History& history);

}  // namespace sweepd
