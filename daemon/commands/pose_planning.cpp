#include <array>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/commands/plan_command.hpp"
#include "daemon/plan/krl_program.hpp"
#include "daemon/plan/plan_text.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/progress.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kBoxNumbers = 6;

Box box_of(const std::vector<double>& corners) {
  const Eigen::Vector3d one(corners.data()), other(corners.data() + 3);
  return {one.cwiseMin(other), one.cwiseMax(other)};
}

/// Throws with all that KRL cannot express.
KrlProgram checked_program(const PosePlan& plan, const KrlOptions& krl) {
  std::string text;
  for (const std::string& finding : krl_findings(plan, krl))
    text += (text.empty() ? "KRL: " : "\nKRL: ") + finding;
  if (!text.empty()) throw ConfigError(text);
  return krl_program(plan, krl);
}

}  // namespace

void add_pose_options(CLI::App& command, PoseTask& poses, CLI::Option& count) {
  const std::size_t before = command.get_options().size();
  PoseLimits& limits = poses.limits;
  command
      .add_option_function<std::array<double, 3>>(
          "--device",
          [&limits](const std::array<double, 3>& at) {
            limits.device_mm = Eigen::Vector3d(at.data());
          },
          "Take static poses only where the target is seen from the device at this point of the "
          "robot's base, in mm")
      ->check(finite())
      ->type_name("X,Y,Z")
      ->delimiter(',');
  command
      .add_option("--cone-deg", limits.cone_deg,
                  "Let the reflector see the device only within this angle from where it looks")
      ->check(number_between(1.0, 180.0))
      ->default_str("it looks everywhere");
  command
      .add_option_function<std::array<double, 3>>(
          "--facing",
          [&limits](const std::array<double, 3>& facing) {
            limits.facing = Eigen::Vector3d(facing.data());
            if (limits.facing.isZero(1e-9))
              throw CLI::ValidationError("--facing", "expected a direction, found 0,0,0");
          },
          "Let the reflector look along this direction of the frame after the last row")
      ->check(finite())
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->default_str("0,0,1");
  add_number(command, "--arm-radius-mm", limits.arm_radius_mm, zero_or_more(),
             "Keep the line of sight this far off the arm. With 0 it may cross it");
  command
      .add_option_function<std::vector<double>>(
          "--keep-out",
          [&limits](const std::vector<double>& corners) {
            if (corners.size() % kBoxNumbers != 0)
              throw CLI::ValidationError("--keep-out",
                                         "expected six numbers, two corners of a box");
            for (std::size_t k = 0; k < corners.size(); k += kBoxNumbers)
              limits.keep_out.push_back(
                  box_of({corners.begin() + static_cast<std::ptrdiff_t>(k),
                          corners.begin() + static_cast<std::ptrdiff_t>(k + kBoxNumbers)}));
          },
          "Keep the arm's lines out of the box between these two corners, in mm of the robot's "
          "base. More boxes: name it again")
      ->check(finite())
      ->type_name("X,Y,Z,X,Y,Z")
      ->delimiter(',');
  command
      .add_option("--floor-mm", limits.floor_mm, "Keep all behind the third axis above this height")
      ->check(finite())
      ->type_name("Z");
  command
      .add_option("--column-mm", limits.column_mm,
                  "Keep all behind the third axis this far off axis 1, up to the height of axis 2")
      ->check(more_than_zero())
      ->type_name("R");
  add_number(command, "--speed-deg-s", poses.speed_deg_s, number_between(0.1, 1000.0),
             "Drive from pose to pose at this speed of every axis");
  add_number(command, "--dwell-s", poses.dwell_s, number_between(0.1, 1000.0),
             "Rest so many seconds at each pose");
  const auto all = command.get_options();
  for (std::size_t k = before; k < all.size(); ++k) all[k]->needs(&count);
}

int plan_static_poses(const PlanOptions& options, std::ostream& out) {
  if (options.propose)
    throw std::invalid_argument("--propose is for sweeps: leave it out with --poses");
  if (options.krl && !options.output)
    throw std::invalid_argument("--krl: expected --output: name the folder of the program");
  RobotDescription robot = load_robot(options.robot);
  if (options.tool_mm && robot.arm) robot.arm->tool_mm = Eigen::Vector3d(options.tool_mm->data());
  PoseTask task = options.poses;
  task.limits.margin_deg = options.margin();
  task.joint_sigma_deg = options.wobble_deg;
  task.position_sigma_mm = options.position_sigma_mm.value_or(task.position_sigma_mm);
  Progress progress("plan");
  const PosePlan plan = plan_poses(robot, task, [&](double done, double total) {
    progress.update(done, total, "static poses");
  });
  progress.clear();

  std::vector<std::pair<std::filesystem::path, std::string>> files;
  if (options.output) {
    const std::string base = (*options.output / options.file_name()).string();
    files.emplace_back(base + ".csv", pose_table(plan));
    if (options.krl) {
      KrlProgram program = checked_program(plan, options.krl_options(robot));
      files.emplace_back(base + ".src", std::move(program.src));
      files.emplace_back(base + ".dat", std::move(program.dat));
    }
  }
  out << pose_plan_text(robot, plan);
  write_edited(Outputs({options.robot}, options.force), options.output, files, out);
  return 0;
}

}  // namespace sweepd
