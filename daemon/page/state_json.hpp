#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/page/metrics.hpp"
#include "daemon/service/service_status.hpp"
#include "daemon/system/process_state.hpp"

namespace sweepd {

/// What /api/state shows: schema "sweepd.state/1". Counts are those since sweepd started. Fields
/// may be added.
[[nodiscard]] std::string state_json(const ServiceStatus& status,
                                     const std::vector<RobotMetrics>& robots,
                                     const ProcessState& process);
/// What is told of one robot there.
[[nodiscard]] nlohmann::ordered_json robot_state_json(const RobotMetrics& robot);

}  // namespace sweepd
