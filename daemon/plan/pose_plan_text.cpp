#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "daemon/plan/outlook_numbers.hpp"
#include "daemon/plan/plan_text.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::DhEstimate;
using identify::DhNumber;
using identify::Knowledge;

/// A prediction that is off by so much is none.
constexpr double kOpenFrom_mm = 100;

std::string point_text(const Eigen::Vector3d& point) {
  return fmt::format("{}, {}, {} mm", plain(point.x()), plain(point.y()), plain(point.z()));
}

/// Of one number for all joints: "5 deg", "5 deg (linear joints: mm)".
std::string joints_text(const RobotDescription& robot, double number, std::string_view per = "") {
  const bool linear = std::ranges::any_of(robot.limits, &JointLimits::linear);
  return fmt::format("{} deg{}", plain(number), per) +
         (linear ? fmt::format(" (linear joints: mm{})", per) : "");
}

std::string rules_text(const RobotDescription& robot, const PoseLimits& limits) {
  std::string text = joints_text(robot, limits.margin_deg) + " off the joint limits";
  if (limits.device_mm) text += "; seen from " + point_text(*limits.device_mm);
  if (limits.device_mm && limits.cone_deg)
    text += fmt::format(" within {} deg", plain(*limits.cone_deg));
  if (!limits.keep_out.empty())
    text += "; out of " + rsi::counted(limits.keep_out.size(), "box", "boxes");
  if (limits.floor_mm) text += fmt::format("; above {} mm", plain(*limits.floor_mm));
  if (limits.column_mm) text += fmt::format("; {} mm off axis 1", plain(*limits.column_mm));
  return text;
}

std::string removed_text(const PosePlan& plan) {
  std::string text =
      left("poses within the joint limits", 60) + right(std::to_string(plan.tried), 8) + "\n";
  for (std::size_t rule = 0; rule < kPoseRules; ++rule)
    if (plan.removed[rule] > 0)
      text += left("- " + words(static_cast<PoseRule>(rule)), 60) +
              right(std::to_string(plan.removed[rule]), 8) + "\n";
  return text + left("allowed, to choose from", 60) + right(std::to_string(plan.allowed()), 8) +
         "\n";
}

std::string pose_table_text(const RobotDescription& robot, const PosePlan& plan) {
  OutlookDecimals decimals;
  decimals.see(plan.outlook.dh);
  std::string text = left("joint", kJointColumn) + right("specified", kValueColumn) +
                     right("std unc", kSigmaColumn) + right("at random", kSigmaColumn) +
                     right("times smaller", 15) + "\n";
  for (std::size_t j = 0; j < plan.outlook.dh.size(); ++j) {
    const DhEstimate& row = plan.outlook.dh[j];
    for (const OutlookNumber& one : kOutlookNumbers) {
      if (!shown(one, row)) continue;
      const DhNumber& found = row.*one.number;
      const DhNumber& blind = plan.at_random.dh[j].*one.number;
      text += line_start(j, one) +
              number(specified_value(robot.arm->rows[j], one), 4, kValueColumn) +
              sigma_text(found, one, decimals.count(), kSigmaColumn);
      if (found.knowledge == Knowledge::identified)
        text += sigma_text(blind, one, decimals.count(), kSigmaColumn) +
                (blind.knowledge == Knowledge::identified ? number(blind.sigma / found.sigma, 2, 15)
                                                          : "");
      text += "\n";
    }
  }
  return text;
}

/// What the poses leave open; empty: nothing.
std::string open_text(const PosePlan& plan) {
  std::string names;
  for (std::size_t j = 0; j < plan.outlook.dh.size(); ++j) {
    const DhEstimate& row = plan.outlook.dh[j];
    for (const auto& of : identify::kDhNumbers)
      if ((row.*of.number).knowledge == Knowledge::undetermined &&
          (of.number != &DhEstimate::beta_rad || has_beta(row)))
        names += fmt::format("{}{} {}", names.empty() ? "" : ", ", of.name, j + 1);
  }
  return names;
}

std::string displacement_text(double of_mm) {
  return of_mm < kOpenFrom_mm ? fixed(of_mm, 4) + " mm" : "not at all";
}

}  // namespace

std::string pose_plan_text(const RobotDescription& robot, const PosePlan& plan) {
  const auto over_home = static_cast<std::size_t>(
      std::count_if(plan.poses.begin(), plan.poses.end(),
                    [](const PlannedPose& pose) { return pose.over_home; }));
  std::string text =
      paragraph("robot       ", robot.name) +
      paragraph("poses       ", fmt::format("{}, each rested at for {} s, at {}: takes {} min",
                                            plan.poses.size(), plain(plan.task.dwell_s),
                                            joints_text(robot, plan.task.speed_deg_s, "/s"),
                                            fixed(plan.duration_s / 60, 1))) +
      paragraph("kept        ", rules_text(robot, plan.task.limits)) +
      paragraph("measured    ",
                fmt::format("by a device, to {} mm (sigma) a coordinate; joints stand {} "
                            "(sigma) off their angles",
                            plain(plan.task.position_sigma_mm),
                            joints_text(robot, plan.task.joint_sigma_deg))) +
      paragraph("target      ",
                point_text(robot.arm->tool_mm) + " in the frame behind the last row");
  text += "\n" + removed_text(plan) + "\nDH parameters and the uncertainties to be expected\n\n" +
          pose_table_text(robot, plan) +
          "(set): such data do not determine it; it is set by convention.\n\n";
  text += paragraph("predicted   ",
                    fmt::format("positions anywhere within the limits to {} (1 sigma, worst pose "
                                "and direction); with as many poses at random to {}",
                                displacement_text(plan.outlook.displacement_mm),
                                displacement_text(plan.at_random.displacement_mm)));
  const std::string open = open_text(plan);
  text += paragraph("open        ",
                    open.empty() ? "nothing of the table; what joints do beside their angles "
                                   "(harmonics, compliance) is looked for, and not promised"
                                 : open +
                                       ": such poses do not determine them; put the target 100 "
                                       "mm or more off the last axis, or allow more poses");
  if (over_home > 0)
    text += paragraph("ways        ", rsi::counted(over_home, "pose") +
                                          " cannot be reached straight from the one before: the "
                                          "program goes over home");
  for (const std::size_t joint : plan.without_limits)
    text += paragraph("limits      ",
                      fmt::format("joint {}: the description has none; 90 {} from home are taken",
                                  joint + 1, robot.limits[joint].linear ? "mm" : "deg"));
  return text + paragraph("CAUTION     ",
                          "sweepd knows joint limits, boxes and a line for the arm, but neither "
                          "the cell, nor cables, nor the robot's own body and tool: drive every "
                          "pose by hand in T1 first");
}

}  // namespace sweepd
