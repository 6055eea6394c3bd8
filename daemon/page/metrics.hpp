#pragma once

#include <memory>
#include <string>
#include <vector>

#include "daemon/service/service_status.hpp"
#include "daemon/system/process_state.hpp"

namespace sweepd {

/// What is told of one robot.
struct RobotMetrics {
  std::shared_ptr<const RobotState> state;    ///< not null
  std::shared_ptr<const ResultState> result;  ///< not null
};

/// The text format of Prometheus, version 0.0.4: units are seconds and bytes, names and labels by
/// its rules.
[[nodiscard]] std::string metrics(const ServiceStatus& status,
                                  const std::vector<RobotMetrics>& robots,
                                  const ProcessState& process);

}  // namespace sweepd
