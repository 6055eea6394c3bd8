#pragma once

#include <string>
#include <vector>

#include "daemon/metrics.hpp"
#include "daemon/process_state.hpp"
#include "daemon/service_status.hpp"

namespace sweepd {

/// What /api/state shows: schema "sweepd.state/1". Counts are those since sweepd started. Fields
/// may be added.
[[nodiscard]] std::string state_json(const ServiceStatus& status,
                                     const std::vector<RobotMetrics>& robots,
                                     const ProcessState& process);

}  // namespace sweepd
