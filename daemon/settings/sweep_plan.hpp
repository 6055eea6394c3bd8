#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/settings/robot_description.hpp"

namespace sweepd {

/// One joint turns from start to end while the others stand at the plan's home. Of a linear joint
/// all is in mm.
struct PlannedSweep {
  std::size_t joint = 0;  ///< from 1
  double start_deg = 0;
  double end_deg = 0;
  double speed_deg_s = 0;
  int line = 0;         ///< in the plan's file
  bool linear = false;  ///< the file says mm

  [[nodiscard]] std::string_view unit() const { return linear ? "mm" : "deg"; }
};

/// The sweep program of a campaign: config/plans/*.toml. Each sweep begins and ends at home: the
/// joint is positioned at its start, rests, sweeps, rests, and goes back. What is said of all
/// joints is said of a linear one in mm: home, speed and acceleration.
struct SweepPlan {
  std::filesystem::path file;
  std::vector<double> home_deg;  ///< one a joint
  double positioning_speed_deg_s = 0;
  double acceleration_deg_s2 = 0;     ///< of every move
  std::chrono::milliseconds dwell{};  ///< rest at both ends of a sweep
  std::vector<PlannedSweep> sweeps;   ///< in order of time, at least one; a joint may come again
};

/// A joint goes from one place to another, and rests there.
struct PlannedMove {
  double from_deg = 0;
  double to_deg = 0;  ///< perhaps the same
  double speed_deg_s = 0;
  std::string place = {};  ///< what `to_deg` is called: "START", "END"; empty: home
  bool measures = false;   ///< it is the sweep; else it leads from home or back
};

/// All that `sweep` of `plan` makes its joint do, in order of time, from home to home.
[[nodiscard]] std::vector<PlannedMove> moves_of(const SweepPlan& plan, const PlannedSweep& sweep);

/// Reads a plan and checks it by itself; throws ConfigError.
[[nodiscard]] SweepPlan load_plan(const std::filesystem::path& file);

/// The plan as a file that load_plan() reads back as the same plan. `remark`, of whole lines,
/// stands at its top as a comment.
[[nodiscard]] std::string plan_toml(const SweepPlan& plan, const std::string& remark = {});

/// What `robot` cannot do of `plan`, one sentence each in the form of a ConfigError; empty if it
/// can do all: as many joints, home, sweeps and speeds within the limits, mm of its linear joints.
[[nodiscard]] std::vector<std::string> check_plan(const SweepPlan& plan,
                                                  const RobotDescription& robot);

}  // namespace sweepd
