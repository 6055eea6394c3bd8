#pragma once

#include <string>

#include "daemon/results/outcome.hpp"
#include "daemon/results/poses_json.hpp"
#include "identify/poses/displacement_map.hpp"

namespace sweepd {

/// 90 degrees (or mm) from the poses' home where a joint's limits are not known.
[[nodiscard]] identify::JointRanges joint_ranges(const PosePredictor& predictor,
                                                 const std::vector<JointLimits>& limits);
/// The limits that result.json has.
[[nodiscard]] std::vector<JointLimits> limits_in(const nlohmann::ordered_json& result);

/// From the specification to what was identified; empty without a specified arm.
[[nodiscard]] identify::DisplacementMap displacement_of(const PosePredictor& predictor,
                                                        const std::vector<JointLimits>& limits);

/// displacement.csv: the grid, then the slices.
[[nodiscard]] std::string displacement_csv(const identify::DisplacementMap& map);

}  // namespace sweepd
