#pragma once

#include <array>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "daemon/plan/krl_program.hpp"
#include "daemon/plan/pose_plan.hpp"
#include "daemon/plan/simulated_robot.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace sweepd {

/// What `sweepd plan` is asked for.
struct PlanOptions {
  std::filesystem::path robot;                                ///< see robot_description.hpp
  std::filesystem::path plan;                                 ///< see sweep_plan.hpp
  int cycle_ms = static_cast<int>(rsi::kUsualCycle.count());  ///< 1 to 1000
  int precision = rsi::kUsualPrecision;             ///< decimals of the controller's numbers
  double wobble_deg = kUsualWobble_deg;             ///< of every joint, standard deviation
  std::optional<double> position_sigma_mm;          ///< another device measures, this well
  std::optional<std::array<double, 3>> tool_mm;     ///< target, in place of the description's
  bool propose = false;                             ///< better ranges
  std::optional<double> margin_deg;                 ///< they keep off the joint limits
  std::optional<std::filesystem::path> write_plan;  ///< of the proposal; needs `propose`
  std::optional<KrlDialect> krl;                    ///< program of the plan as given, into `output`
  std::optional<std::filesystem::path> output;      ///< folder; of sweeps set together with `krl`
  std::string name;      ///< of the program; empty: sweepd_sweeps, of poses sweepd_poses
  int krl_tool = 1;      ///< number of the controller's tool
  std::string rsi_file;  ///< as in KrlOptions
  bool force = false;    ///< over any file but robot and plan
  /// Static poses in place of a plan's sweeps, where it asks for any. Margin, sigmas and tool are
  /// those above.
  PoseTask poses = {};

  /// Of proposed ranges and poses.
  static constexpr int kMargin_deg = 5;
  [[nodiscard]] double margin() const { return margin_deg.value_or(kMargin_deg); }
  /// Of the program and its files.
  [[nodiscard]] std::string file_name() const;
  [[nodiscard]] KrlOptions krl_options(const RobotDescription& of) const;
};

/// With poses, plan_static_poses(). Else: checks the plan against the robot, says what
/// uncertainties it will lead to, proposes a better one and writes the program that runs it, as far
/// as asked for. The text goes to `out`.
///
/// Returns the exit code: 0 or, where the plan is refused (see plan_outlook.hpp), 1, and `errors`
/// says why and what to do; then nothing is written. What counts is the proposed plan where one is
/// asked for and no KRL, else the plan as given.
///
/// Throws ConfigError for files that are wrong, plans beyond the limits (with all findings) and
/// what KRL cannot express; std::invalid_argument for wrong options, and as
/// Outputs where a file may not be written; std::runtime_error where a
/// file cannot be written.
[[nodiscard]] int plan(const PlanOptions& options, std::ostream& out = std::cout,
                       std::ostream& errors = std::cerr);

CLI::App* add_plan(CLI::App& app, PlanOptions& options);

/// Adds those options of `sweepd plan` that are of static poses alone: they need `count`, which is
/// --poses.
void add_pose_options(CLI::App& command, PoseTask& poses, CLI::Option& count);

/// `sweepd plan --poses`: chooses poses, says what they will tell, writes their table and, where a
/// dialect is named, the program that drives them. Returns 0. Throws as plan_poses() and, for
/// files, as plan().
[[nodiscard]] int plan_static_poses(const PlanOptions& options, std::ostream& out = std::cout);

}  // namespace sweepd
