#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "daemon/service/published.hpp"
#include "daemon/service/robot_state.hpp"

namespace sweepd {

/// How the whole service is, as the thread that leads it publishes it about once a second.
struct ServiceStatus {
  enum class Phase { starting, serving, stopping };
  Phase phase = Phase::starting;
  std::vector<std::shared_ptr<const RobotStatus>> robots;  ///< that are served
  /// The threads that stand still, a sentence each: see Heartbeat.
  std::vector<std::string> standstills;
  std::chrono::steady_clock::time_point looked{};  ///< when that was found out

  struct NotServed {
    std::string robot;
    std::string reason;
  };
  std::vector<NotServed> not_served = {};  ///< robots of the settings that are tried again

  [[nodiscard]] bool ready() const { return phase == Phase::serving && not_served.empty(); }
};

/// What `systemctl status` shows: of each robot the stream, its telegrams, the last sweep and the
/// last result; before them what is wrong: threads that stand still, robots that are not served.
[[nodiscard]] std::string status_line(const ServiceStatus& status);

}  // namespace sweepd
