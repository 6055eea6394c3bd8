#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/results/outcome.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/chain/chain_estimate.hpp"
#include "identify/dh/dh_comparison.hpp"
#include "identify/identification.hpp"

namespace sweepd {

// Parts of result.json and of other results' JSON: first lengths and angles, as all of it has them.

[[nodiscard]] inline nlohmann::ordered_json json_length(double mm) {
  return rounded(mm, kLengthDecimals);
}
[[nodiscard]] inline nlohmann::ordered_json json_angle(double radians) {
  return rounded(degrees(radians), kAngleDecimals);
}
/// Of small angles.
[[nodiscard]] inline nlohmann::ordered_json json_arcsec(double radians) {
  return rounded(arcsec(radians), kArcsecDecimals);
}
/// What is left of poses.
[[nodiscard]] inline nlohmann::ordered_json json_left(const identify::Left& left) {
  return {{"mean_mm", json_length(left.mean_mm)},
          {"rms_mm", json_length(left.rms_mm)},
          {"max_mm", json_length(left.most_mm)}};
}

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

/// What result.json tells of the chain estimator besides its table: how the fit ended, the noise it
/// found, and for each joint whether its angles were believed, and why.
[[nodiscard]] nlohmann::ordered_json chain_json(const identify::ChainEstimate& estimate);

/// "currents" of result.json: friction of each joint that has any.
[[nodiscard]] nlohmann::ordered_json currents_json(const Outcome& outcome);

}  // namespace sweepd
