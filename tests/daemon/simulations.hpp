#pragma once

#include <filesystem>
#include <sstream>
#include <string>

#include "daemon/commands/simulate_command.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace sweepd::test {

/// A plan in which one joint turns through five degrees and jumps back; all else takes 0.1 s.
inline std::filesystem::path write_plan(const TemporaryFolder& folder,
                                        const std::string& speed_deg_s) {
  return folder.write("plan.toml",
                      "home_deg = [90, -90, 90, 0, 90, 0]\n"
                      "positioning_speed_deg_s = 700\nacceleration_deg_s2 = 100000\n"
                      "dwell_ms = 20\n"
                      "[[sweep]]\njoint = 6\nstart_deg = 0\nend_deg = 5\nspeed_deg_s = " +
                          speed_deg_s + "\n");
}

/// A KR 5 arc that runs `plan`.
inline SimulateOptions simulation_of(
    const std::filesystem::path& plan = kConfig / "plans/kr5_arc_30deg.toml") {
  SimulateOptions options;
  options.robot = kConfig / "robots/kr5_arc.toml";
  options.plan = plan;
  return options;
}

struct Simulated {
  int code;
  std::string report;
  std::string errors;
};

inline Simulated run(const SimulateOptions& options) {
  std::ostringstream report;
  std::ostringstream errors;
  const int code = simulate(options, report, errors);
  return {code, report.str(), errors.str()};
}

}  // namespace sweepd::test
