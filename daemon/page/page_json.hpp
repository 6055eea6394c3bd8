#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/page/metrics.hpp"
#include "daemon/service/live_slices.hpp"
#include "daemon/service/service_status.hpp"
#include "daemon/system/process_state.hpp"

namespace sweepd {

// What the pages tell as JSON: /api/state, and the events of the live page.

/// What /api/state shows: schema "sweepd.state/1". Counts are those since sweepd started. Fields
/// may be added.
[[nodiscard]] std::string state_json(const ServiceStatus& status,
                                     const std::vector<RobotMetrics>& robots,
                                     const ProcessState& process);
/// What is told of one robot there.
[[nodiscard]] nlohmann::ordered_json robot_state_json(const RobotMetrics& robot);

// What the events of /api/live carry, schema "sweepd.live/1": a line of JSON each, described in
// docs/live-page.md.

[[nodiscard]] std::string hello_json(const std::string& robot, const RobotFacts& facts);
/// Of slices of one session, which are not empty.
[[nodiscard]] std::string cycles_json(const std::vector<LiveSlice>& slices);
[[nodiscard]] std::string samples_json(const std::vector<LiveSlice>& slices);
[[nodiscard]] std::string sweep_json(const LiveSweep& sweep);
[[nodiscard]] std::string link_json(const RobotMetrics& robot);
/// Its tables are text: the very digits of result.json.
[[nodiscard]] std::string result_event_json(const ResultState::Newest& result);

}  // namespace sweepd
