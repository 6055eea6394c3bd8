#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <pugixml.hpp>

#include "daemon/results/result_formats.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

using Group = identify::KinematicModel::Group;

double value(const Group& group, std::string_view name) {
  return std::find_if(group.begin(), group.end(),
                      [&](const auto& entry) { return entry.name == name; })
      ->number.value;
}

void set(pugi::xml_node node, const char* name, const std::string& text) {
  node.append_attribute(name) = text.c_str();
}

void add_link(pugi::xml_node robot, const std::string& name) {
  set(robot.append_child("link"), "name", name);
}

pugi::xml_node add_joint(pugi::xml_node robot, const std::string& name, const char* type,
                         const std::string& parent, const std::string& child, const Group& origin) {
  auto joint = robot.append_child("joint");
  set(joint, "name", name);
  set(joint, "type", type);
  set(joint.append_child("parent"), "link", parent);
  set(joint.append_child("child"), "link", child);
  const auto scaled = [&](double scale, std::string_view number) {
    return number_text(scale * value(origin, number) + 0.0);  // no -0
  };
  const auto three = [&](double scale, std::string_view a, std::string_view b, std::string_view c) {
    return scaled(scale, a) + " " + scaled(scale, b) + " " + scaled(scale, c);
  };
  auto node = joint.append_child("origin");
  set(node, "xyz", three(1e-3, "x", "y", "z"));
  set(node, "rpy", three(1, "roll", "pitch", "yaw"));
  return joint;
}

/// Lower and upper limit of a joint's value: rad, or m.
struct UrdfRange {
  double lower = 0;
  double upper = 0;
};

/// URDF demands limits of a prismatic joint: where the description has none, what was swept.
UrdfRange swept_range(const identify::Identification& found, std::size_t j) {
  const identify::JointResult& joint = found.joints[j];
  double least = 0, most = 0;
  bool any = false;
  for (const identify::Sweep& sweep : joint.sweeps)
    for (const identify::Sample& sample : *sweep.samples) {
      if (sample.joints <= j) continue;
      least = any ? std::min(least, sample.angles_rad[j]) : sample.angles_rad[j];
      most = any ? std::max(most, sample.angles_rad[j]) : sample.angles_rad[j];
      any = true;
    }
  const double from_home = found.home_rad[j] ? 0 : least;  // a joint that counts from there
  if (any) return {1e-3 * degrees(least - from_home), 1e-3 * degrees(most - from_home)};
  const double length = joint.line ? joint.line->length_mm : 0;
  const double home = found.home_rad[j] ? degrees(*found.home_rad[j]) : 0;
  return {1e-3 * (home - length), 1e-3 * (home + length)};
}

std::string link_name(std::size_t joint) {
  return joint == 0 ? "base_link" : "link_" + std::to_string(joint);
}

}  // namespace

std::string urdf(const identify::KinematicModel& model, const Outcome& outcome) {
  const std::vector<JointLimits>& limits = outcome.limits;
  std::string name = outcome.robot;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '_');
  pugi::xml_document document;
  auto declaration = document.append_child(pugi::node_declaration);
  set(declaration, "version", "1.0");
  set(declaration, "encoding", "UTF-8");
  auto root = document.append_child("robot");
  set(root, "name", name);
  const std::string metres = std::count(model.linear.begin(), model.linear.end(), true) > 0
                                 ? "Those of prismatic joints are metres. "
                                 : "";
  root.append_child(pugi::node_comment)
      .set_value(
          (" base_link is the measurement frame, tool0 lies at the target point. Joint values are "
           "the controller's angles, those of joints named ..._from_home count from home. " +
           metres +
           "Velocity limits are the robot description's. Effort is not known, but URDF demands it: "
           "0. ")
              .c_str());
  const std::size_t joints = model.joints();
  for (std::size_t j = 0; j <= joints; ++j) add_link(root, link_name(j));
  add_link(root, "tool0");
  for (std::size_t j = 1; j <= joints; ++j) {
    const bool absolute = outcome.identification.home_rad[j - 1].has_value();
    const bool limited = absolute && j <= limits.size() && std::isfinite(limits[j - 1].min_deg) &&
                         std::isfinite(limits[j - 1].max_deg);
    const bool linear = model.linear[j - 1];
    const Group& group = model.groups[j];
    auto joint = add_joint(root, "joint_" + std::to_string(j) + (absolute ? "" : "_from_home"),
                           linear    ? "prismatic"
                           : limited ? "revolute"
                                     : "continuous",
                           link_name(j - 1), link_name(j), group);
    set(joint.append_child("axis"), "xyz", value(group, "axis_z") < 0 ? "0 0 -1" : "0 0 1");
    const auto in_joint_units = [&](double value) {
      return linear ? 1e-3 * value : radians(value);
    };
    const double speed = j <= limits.size() ? limits[j - 1].max_speed_deg_s
                                            : std::numeric_limits<double>::infinity();
    if (!limited && !linear && !std::isfinite(speed)) continue;
    auto limit = joint.append_child("limit");
    if (limited || linear) {
      const UrdfRange range = limited ? UrdfRange{in_joint_units(limits[j - 1].min_deg),
                                                  in_joint_units(limits[j - 1].max_deg)}
                                      : swept_range(outcome.identification, j - 1);
      set(limit, "lower", number_text(range.lower));
      set(limit, "upper", number_text(range.upper));
    }
    set(limit, "effort", "0");
    set(limit, "velocity", std::isfinite(speed) ? number_text(in_joint_units(speed)) : "0");
  }
  add_joint(root, "tool0_fixed", "fixed", link_name(joints), "tool0", model.groups.back());
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace sweepd
