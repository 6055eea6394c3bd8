#pragma once

// A SCARA (R R P R) from its description and plan to an outcome, as the daemon has it.

#include <string>

#include "daemon/plan/rehearsal.hpp"
#include "daemon/results/outcome.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace sweepd::test {

inline const std::string kScara = R"(
name = "SCARA"
home_deg = [20.0, 60.0, 100.0, -30.0]
tool_mm = [150.0, 60.0, 0.0]
[[joint]]
b_mm = 0.0
theta_deg = 20.0
a_mm = 250.0
alpha_deg = 0.0
positive = 1
[[joint]]
b_mm = 0.0
theta_deg = 60.0
a_mm = 300.0
alpha_deg = 0.0
positive = 1
[[joint]]
type = "linear"
b_mm = -120.0
theta_deg = 15.0
a_mm = 0.0
alpha_deg = 0.0
positive = -1
min_mm = 0.0
max_mm = 200.0
max_speed_mm_s = 1200.0
[[joint]]
b_mm = 0.0
theta_deg = 0.0
a_mm = 0.0
alpha_deg = 0.0
positive = 1
)";

inline const std::string kScaraPlan = R"(
home_deg = [20.0, 60.0, 100.0, -30.0]
positioning_speed_deg_s = 60.0
acceleration_deg_s2 = 200.0
dwell_ms = 300
[[sweep]]
joint = 1
start_deg = -25.0
end_deg = 65.0
speed_deg_s = 30.0
[[sweep]]
joint = 2
start_deg = 15.0
end_deg = 105.0
speed_deg_s = 30.0
[[sweep]]
joint = 3
start_mm = 20.0
end_mm = 180.0
speed_mm_s = 50.0
[[sweep]]
joint = 4
start_deg = -75.0
end_deg = 15.0
speed_deg_s = 30.0
)";

inline RobotDescription scara_description() {
  const TemporaryFolder folder;
  return load_robot(folder.write("scara.toml", kScara));
}

inline SweepPlan scara_plan() {
  const TemporaryFolder folder;
  return load_plan(folder.write("plan.toml", kScaraPlan));
}

/// What a SCARA of just that table gives, its joints wobbling.
inline Outcome scara_outcome(const Measurement& measurement = {}) {
  const RobotDescription robot = scara_description();
  const Rehearsal rehearsal = rehearse(robot, scara_plan(), measurement);
  Outcome outcome;
  outcome.robot = robot.name;
  outcome.identification = rehearsal.identification;
  outcome.positive = robot.arm->positive;
  outcome.limits = robot.limits;
  return outcome;
}

}  // namespace sweepd::test
