#include "daemon/settings/sweep_plan.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/settings/toml_table.hpp"

namespace sweepd {
namespace {

constexpr double kLeastSpeed_deg_s = 0.01;
constexpr double kMostSpeed_deg_s = 1000;
constexpr double kMostAcceleration_deg_s2 = 1e5;
constexpr double kMostAngle_deg = 1e5;
constexpr std::int64_t kMostDwell_ms = 600'000;

/// The keys of a sweep, by what they are in.
struct SweepKeys {
  std::string_view start, end, speed;
};
constexpr SweepKeys kInDegrees{"start_deg", "end_deg", "speed_deg_s"};
constexpr SweepKeys kInMillimetres{"start_mm", "end_mm", "speed_mm_s"};

PlannedSweep read_sweep(const TomlTable& table, std::size_t joints) {
  PlannedSweep sweep;
  sweep.linear = table.has("start_mm") || table.has("end_mm") || table.has("speed_mm_s");
  const SweepKeys& keys = sweep.linear ? kInMillimetres : kInDegrees;
  table.allow_only({"joint", keys.start, keys.end, keys.speed});
  sweep.line = table.line();
  sweep.joint =
      static_cast<std::size_t>(table.whole_number("joint", 1, static_cast<std::int64_t>(joints)));
  sweep.start_deg = table.number(keys.start, -kMostAngle_deg, kMostAngle_deg);
  sweep.end_deg = table.number(keys.end, -kMostAngle_deg, kMostAngle_deg);
  sweep.speed_deg_s = table.number(keys.speed, kLeastSpeed_deg_s, kMostSpeed_deg_s);
  if (sweep.start_deg == sweep.end_deg)
    table.fail(keys.end, sweep.linear ? "expected another place than start_mm, found the same: a "
                                        "sweep has to move the joint"
                                      : "expected another angle than start_deg, found the same: a "
                                        "sweep has to turn the joint");
  return sweep;
}

}  // namespace

std::vector<PlannedMove> moves_of(const SweepPlan& plan, const PlannedSweep& sweep) {
  const double home_deg = plan.home_deg[sweep.joint - 1];
  return {{home_deg, sweep.start_deg, plan.positioning_speed_deg_s, "START"},
          {sweep.start_deg, sweep.end_deg, sweep.speed_deg_s, "END", true},
          {sweep.end_deg, home_deg, plan.positioning_speed_deg_s}};
}

SweepPlan load_plan(const std::filesystem::path& file) {
  const TomlTable top = TomlTable::load(file);
  if (top.has("joint"))
    top.fail(
        "joint",
        "expected a plan of sweeps, found a robot description: give it as the robot (--robot)");
  top.allow_only(
      {"home_deg", "positioning_speed_deg_s", "acceleration_deg_s2", "dwell_ms", "sweep"});
  SweepPlan plan;
  plan.file = file;
  plan.home_deg = top.numbers("home_deg", -kMostAngle_deg, kMostAngle_deg);
  if (plan.home_deg.empty() || plan.home_deg.size() > 12)
    top.fail("home_deg", "expected 1 to 12 angles, one a joint, found " + top.found("home_deg") +
                             ": give the pose from which each sweep begins");
  plan.positioning_speed_deg_s =
      top.number("positioning_speed_deg_s", kLeastSpeed_deg_s, kMostSpeed_deg_s);
  plan.acceleration_deg_s2 = top.number("acceleration_deg_s2", 1, kMostAcceleration_deg_s2);
  plan.dwell = std::chrono::milliseconds(top.whole_number("dwell_ms", 0, kMostDwell_ms));
  for (const TomlTable& table : top.tables("sweep"))
    plan.sweeps.push_back(read_sweep(table, plan.home_deg.size()));
  return plan;
}

std::string plan_toml(const SweepPlan& plan, const std::string& remark) {
  std::string text;
  for (std::size_t from = 0; from < remark.size();) {
    const std::size_t end = std::min(remark.find('\n', from), remark.size());
    text += end == from ? "#\n" : "# " + remark.substr(from, end - from) + "\n";
    from = end + 1;
  }
  if (!text.empty()) text += '\n';
  text += "home_deg = [";
  for (std::size_t i = 0; i < plan.home_deg.size(); ++i)
    text += (i > 0 ? ", " : "") + number_text(plan.home_deg[i]);
  text += fmt::format("]\npositioning_speed_deg_s = {}\nacceleration_deg_s2 = {}\ndwell_ms = {}\n",
                      number_text(plan.positioning_speed_deg_s),
                      number_text(plan.acceleration_deg_s2), plan.dwell.count());
  for (const PlannedSweep& sweep : plan.sweeps) {
    text += fmt::format("\n[[sweep]]\njoint = {}\n", sweep.joint);
    const SweepKeys& keys = sweep.linear ? kInMillimetres : kInDegrees;
    for (const auto& [key, value] : {std::pair{keys.start, sweep.start_deg},
                                     {keys.end, sweep.end_deg},
                                     {keys.speed, sweep.speed_deg_s}})
      text += fmt::format("{} = {}\n", key, number_text(value));
  }
  return text;
}

std::vector<std::string> check_plan(const SweepPlan& plan, const RobotDescription& robot) {
  std::vector<std::string> findings;
  const std::string file = plan.file.string();
  if (plan.home_deg.size() != robot.joints()) {
    findings.push_back(fmt::format(
        "{}: home_deg: expected {} angles, as the robot has joints, found {}: choose the plan of "
        "this robot",
        file, robot.joints(), plan.home_deg.size()));
    return findings;
  }
  const auto check = [&](const std::string& place, std::size_t joint, double angle_deg) {
    const JointLimits& limits = robot.limits[joint - 1];
    if (limits.contain(angle_deg)) return;
    findings.push_back(fmt::format(
        "{}: expected joint {} from {} to {} {}, found {}: correct it, or the limits in the robot "
        "description",
        place, joint, number_text(limits.min_deg), number_text(limits.max_deg), limits.unit(),
        number_text(angle_deg)));
  };
  const auto check_speed = [&](const std::string& place, std::size_t joint, double speed_deg_s) {
    const double most_deg_s = robot.limits[joint - 1].max_speed_deg_s;
    if (speed_deg_s <= most_deg_s) return;
    findings.push_back(fmt::format(
        "{}: expected at most {} {} per second, as joint {} can do no more, found {}: sweep "
        "slower, or correct the limit in the robot description",
        place, number_text(most_deg_s), robot.limits[joint - 1].unit(), joint,
        number_text(speed_deg_s)));
  };
  for (std::size_t i = 0; i < plan.home_deg.size(); ++i)
    check(file + ": home_deg", i + 1, plan.home_deg[i]);
  for (const PlannedSweep& sweep : plan.sweeps) {
    const auto place = fmt::format("{}:{}", file, sweep.line);
    if (sweep.linear != robot.limits[sweep.joint - 1].linear) {
      findings.push_back(fmt::format(
          "{}: expected {}, as joint {} {}, found those of the other kind: correct the keys, or "
          "type in the robot description",
          place,
          sweep.linear ? "start_deg, end_deg and speed_deg_s" : "start_mm, end_mm and speed_mm_s",
          sweep.joint, sweep.linear ? "turns" : "is linear"));
      continue;
    }
    const SweepKeys& keys = sweep.linear ? kInMillimetres : kInDegrees;
    const auto key = [&](std::string_view name) {
      return fmt::format("{}: sweep.{}", place, name);
    };
    check(key(keys.start), sweep.joint, sweep.start_deg);
    check(key(keys.end), sweep.joint, sweep.end_deg);
    check_speed(key(keys.speed), sweep.joint, sweep.speed_deg_s);
  }
  // Only joints that sweep are positioned; one finding for the speed of all.
  const PlannedSweep* slowest = nullptr;
  for (const PlannedSweep& sweep : plan.sweeps) {
    const double most_deg_s = robot.limits[sweep.joint - 1].max_speed_deg_s;
    if (slowest == nullptr || most_deg_s < robot.limits[slowest->joint - 1].max_speed_deg_s)
      slowest = &sweep;
  }
  if (slowest != nullptr)
    check_speed(file + ": positioning_speed_deg_s", slowest->joint, plan.positioning_speed_deg_s);
  return findings;
}

}  // namespace sweepd
