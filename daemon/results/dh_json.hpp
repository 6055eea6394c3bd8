#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "identify/dh/dh_comparison.hpp"
#include "identify/identification.hpp"

namespace sweepd {

/// A row, of the joint with this index; a table's rows: each number with its standard uncertainty
/// and 95 % interval, null where the data do not determine it. In mm and degrees.
[[nodiscard]] nlohmann::ordered_json dh_json(std::size_t index, const identify::DhEstimate& row);
[[nodiscard]] nlohmann::ordered_json dh_json(const std::vector<identify::DhEstimate>& rows);
[[nodiscard]] nlohmann::ordered_json dh_json(const std::vector<identify::DhRow>& specified);
[[nodiscard]] nlohmann::ordered_json dh_json(
    const std::vector<identify::DhDifference>& differences);

/// Covariances of all identified numbers of `found.dh`, with their names ("a3_mm").
[[nodiscard]] nlohmann::ordered_json covariance_json(const identify::Identification& found);

/// What each cause has for a share in each identified number's variance.
[[nodiscard]] nlohmann::ordered_json budget_json(const identify::Identification& found);

}  // namespace sweepd
