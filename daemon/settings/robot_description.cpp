#include "daemon/settings/robot_description.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

constexpr double kLongest_mm = 1e5;
constexpr double kTurn_deg = 360;
constexpr double kMostTurns_deg = 1e5;  // endless joints exist
constexpr double kSlowestJoint_deg_s = 0.1;
constexpr double kFastestJoint_deg_s = 1e4;
constexpr double kMostSag_arcsec = 3600;
constexpr double kHeaviest_kg = 100000;

constexpr std::array<std::string_view, 5> kRowKeys{"b_mm", "theta_deg", "a_mm", "alpha_deg",
                                                   "positive"};

bool has_row(const TomlTable& joint) {
  return std::any_of(kRowKeys.begin(), kRowKeys.end(), [&](auto key) { return joint.has(key); });
}

/// The keys of a joint's limits, by its type.
struct LimitKeys {
  std::string_view least, most, speed;
};
constexpr LimitKeys kOfTurning{"min_deg", "max_deg", "max_speed_deg_s"};
constexpr LimitKeys kOfLinear{"min_mm", "max_mm", "max_speed_mm_s"};

bool read_linear(const TomlTable& joint) {
  if (!joint.has("type")) return false;
  const std::string type = joint.text("type");
  if (type != "linear" && type != "revolute")
    joint.fail("type", "expected \"revolute\" or \"linear\", found " + joint.found("type") +
                           ": write one of them");
  return type == "linear";
}

JointLimits read_limits(const TomlTable& joint) {
  JointLimits limits;
  limits.linear = read_linear(joint);
  const LimitKeys& keys = limits.linear ? kOfLinear : kOfTurning;
  const LimitKeys& others = limits.linear ? kOfTurning : kOfLinear;
  for (const auto& [key, other] :
       {std::pair{keys.least, others.least}, {keys.most, others.most}, {keys.speed, others.speed}})
    if (joint.has(other))
      joint.fail(other, "expected " + std::string(key) + " of a joint with type = \"" +
                            (limits.linear ? "linear" : "revolute") + "\", found " +
                            std::string(other) + ": correct the key or the type");
  if (joint.has(keys.speed))
    limits.max_speed_deg_s = joint.number(keys.speed, kSlowestJoint_deg_s, kFastestJoint_deg_s);
  if (!joint.has(keys.least) && !joint.has(keys.most)) return limits;
  limits.min_deg = joint.number(keys.least, -kMostTurns_deg, kMostTurns_deg);
  limits.max_deg = joint.number(keys.most, -kMostTurns_deg, kMostTurns_deg);
  if (limits.min_deg >= limits.max_deg)
    joint.fail(keys.most, "expected more than " + std::string(keys.least) + " = " +
                              number_text(limits.min_deg) + ", found " + joint.found(keys.most) +
                              ": exchange or correct them");
  return limits;
}

/// Beside a parallel axis that of a linear joint has no place to be off.
void check_linear_rows(const std::vector<TomlTable>& joints, const identify::Arm& arm) {
  constexpr double kParallel = 1e-6;
  for (std::size_t i = 0; i + 1 < arm.joints(); ++i)
    if (arm.is_linear(i) && std::abs(std::sin(arm.rows[i].alpha_rad)) < kParallel &&
        arm.rows[i].a_mm != 0)
      joints[i].fail("a_mm",
                     "expected 0, as the joint is linear and the next axis parallel to it, "
                     "found " +
                         joints[i].found("a_mm") +
                         ": its axis has a direction and no place: let it lie on the next "
                         "axis, and add what is between them to a_mm of the row before");
}

void read_row(const TomlTable& joint, identify::Arm& arm) {
  for (const auto key : kRowKeys)
    if (!joint.has(key))
      joint.fail(key,
                 "missing: expected b_mm, theta_deg, a_mm, alpha_deg and positive in every "
                 "[[joint]], or in none: add it, or leave all of them out");
  arm.rows.push_back({joint.number("b_mm", -kLongest_mm, kLongest_mm),
                      joint.number("theta_deg", -kTurn_deg, kTurn_deg) * kDegree,
                      joint.number("a_mm", -kLongest_mm, kLongest_mm),
                      joint.number("alpha_deg", -kTurn_deg, kTurn_deg) * kDegree});
  const std::int64_t positive = joint.whole_number("positive", INT64_MIN, INT64_MAX);
  if (positive != 1 && positive != -1)
    joint.fail("positive", "expected 1 or -1, found " + joint.found("positive") + ": choose one");
  arm.positive.push_back(static_cast<int>(positive));
}

/// A table in metres or radians reads like one of another robot.
void check_units(const std::vector<TomlTable>& joints, const identify::Arm& arm) {
  constexpr double kRightAngle_rad = 1.5708, kRounded = 0.001;
  constexpr double kShortestArm_mm = 5;
  constexpr std::size_t kOfAnArm = 3;  // lengths that are no whole numbers: two may well be small
  double longest_mm = 0;
  std::size_t lengths = 0, of = 0;
  std::string_view key;
  for (std::size_t i = 0; i < arm.joints(); ++i) {
    const identify::DhRow& row = arm.rows[i];
    const double turned_deg = std::abs(row.alpha_rad) / kDegree;
    for (const double right_angles : {1.0, 2.0})
      if (std::abs(turned_deg - right_angles * kRightAngle_rad) < kRounded)
        joints[i].fail("alpha_deg",
                       fmt::format("expected degrees, found {}, {} degrees in radians: write {}, "
                                   "and the other angles of the file in degrees",
                                   joints[i].found("alpha_deg"), number_text(90 * right_angles),
                                   number_text(std::copysign(90 * right_angles, row.alpha_rad))));
    const double place_mm = arm.is_linear(i) ? 0 : row.b_mm;
    for (const auto& [length, name] : {std::pair{place_mm, "b_mm"}, {row.a_mm, "a_mm"}}) {
      lengths += length == std::round(length) ? 0 : 1;
      if (std::abs(length) > longest_mm) {
        longest_mm = std::abs(length);
        of = i;
        key = name;
      }
    }
  }
  if (lengths >= kOfAnArm && longest_mm < kShortestArm_mm)
    joints[of].fail(key, fmt::format("expected mm, found {} as the greatest length of the table, "
                                     "which looks like metres: multiply all lengths by 1000",
                                     joints[of].found(key)));
}

void read_home(const TomlTable& top, RobotDescription& robot) {
  robot.home_deg = top.numbers("home_deg", -kMostTurns_deg, kMostTurns_deg);
  if (robot.home_deg.size() != robot.joints())
    top.fail("home_deg",
             fmt::format("expected {} angles, one a [[joint]], found {}: make them as many",
                         robot.joints(), top.found("home_deg")));
  for (std::size_t i = 0; i < robot.joints(); ++i)
    if (!robot.limits[i].contain(robot.home_deg[i]))
      top.fail(
          "home_deg",
          fmt::format(
              "expected joint {} from {} to {}, found {}: correct it, or the limits of the joint",
              i + 1, number_text(robot.limits[i].min_deg), number_text(robot.limits[i].max_deg),
              number_text(robot.home_deg[i])));
}

Eigen::Vector3d read_point(const TomlTable& table, std::string_view key) {
  const std::vector<double> point = table.numbers(key, -kLongest_mm, kLongest_mm);
  if (point.size() != 3)
    table.fail(key, "expected [x, y, z], found " + table.found(key) + ": write three numbers");
  return {point[0], point[1], point[2]};
}

/// Of any length.
Eigen::Vector3d read_up(const TomlTable& table) {
  const Eigen::Vector3d up = read_point(table, "up");
  if (!(up.norm() > 0))
    table.fail("up", "expected a direction, found " + table.found("up") +
                         ": write [0, 0, 1] for a robot that stands on the floor, [0, 0, -1] for "
                         "one that hangs from a ceiling");
  return up.normalized();
}

/// What a joint carries, or the payload: a mass and where its centre is.
void read_load(const TomlTable& table, std::string_view mass, std::string_view center,
               std::size_t joint, std::vector<identify::Load>& loads) {
  if (!table.has(mass) && !table.has(center)) return;
  loads.push_back({table.number(mass, 0, kHeaviest_kg), joint, read_point(table, center)});
}

}  // namespace

RobotDescription load_robot(const std::filesystem::path& file) {
  const TomlTable top = TomlTable::load(file);
  if (top.has("sweep"))
    top.fail("sweep",
             "expected a robot description, found a plan of sweeps: give it as the plan (--plan)");
  top.allow_only(
      {"name", "source", "home_deg", "tool_mm", "up", "payload_kg", "payload_center_mm", "joint"});
  const std::vector<TomlTable> joints = top.tables("joint");
  if (joints.size() > 12)
    joints[12].fail(
        "joint",
        fmt::format("expected 1 to 12 joints, found {}: an arm of so many is not supported",
                    joints.size()));

  RobotDescription robot;
  robot.name = top.text("name");
  if (top.has("source")) robot.source = top.text("source");

  std::vector<std::string_view> keys(kRowKeys.begin(), kRowKeys.end());
  keys.insert(keys.end(), {"type", "sag_arcsec", "mass_kg", "center_mm"});
  for (const LimitKeys& of : {kOfTurning, kOfLinear})
    keys.insert(keys.end(), {of.least, of.most, of.speed});
  for (const TomlTable& joint : joints) {
    joint.allow_only(keys);
    robot.limits.push_back(read_limits(joint));
    robot.sag_arcsec.push_back(
        joint.has("sag_arcsec") ? joint.number("sag_arcsec", 0, kMostSag_arcsec) : 0);
    read_load(joint, "mass_kg", "center_mm", robot.sag_arcsec.size() - 1, robot.loads);
  }
  read_load(top, "payload_kg", "payload_center_mm", robot.joints() - 1, robot.loads);

  const bool specified = std::any_of(joints.begin(), joints.end(), has_row);
  if (specified || top.has("home_deg")) read_home(top, robot);
  if (specified) {
    identify::Arm& arm = robot.arm.emplace();
    for (const TomlTable& joint : joints) read_row(joint, arm);
    for (const double angle_deg : robot.home_deg) arm.home_rad.push_back(angle_deg * kDegree);
    for (const JointLimits& limits : robot.limits) arm.linear.push_back(limits.linear);
    check_units(joints, arm);
    check_linear_rows(joints, arm);
    if (top.has("tool_mm")) arm.tool_mm = read_point(top, "tool_mm");
    if (top.has("up")) robot.up = read_up(top);
  } else {
    const auto refuse = [&](std::string_view key, std::string_view what) {
      if (top.has(key))
        top.fail(key, fmt::format("expected no {}, as no [[joint]] has a row, found {}: leave it "
                                  "out, or add the DH table",
                                  what, top.found(key)));
    };
    refuse("tool_mm", "tool point in the frame after the last row");
    refuse("up", "direction in the base of the DH table");
  }
  return robot;
}

}  // namespace sweepd
