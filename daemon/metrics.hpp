#pragma once

#include <memory>
#include <string>
#include <vector>

#include "daemon/process_state.hpp"
#include "daemon/robot_state.hpp"

namespace sweepd {

/// What is told of one robot.
struct RobotMetrics {
  std::shared_ptr<const RobotState> state;    ///< not null
  std::shared_ptr<const ResultState> result;  ///< not null
};

/// The text format of Prometheus, version 0.0.4: units are seconds and bytes, names and labels by
/// its rules. `ready` is what /readyz says.
[[nodiscard]] std::string metrics(const std::vector<RobotMetrics>& robots,
                                  const ProcessState& process, bool ready);

}  // namespace sweepd
