#include "daemon/results/report.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <spdlog/fmt/fmt.h>

#include "daemon/results/outcome.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"
#include "identify/chain/delay.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::Identification;
using rsi::counted;

/// Axes from elsewhere: nothing was swept.
bool is_given(const Outcome& outcome) {
  return outcome.identification.estimator == identify::Estimator::axes;
}

std::string points_text(const PointCounts& points) {
  std::string text = std::to_string(points.points);
  if (points.sweeps > 0 || points.poses == 0) text += " in " + counted(points.sweeps, "sweep");
  if (points.poses > 0)
    text += (points.sweeps > 0 ? " and " : " in ") + counted(points.poses, "static pose");
  text += " of " + counted(points.files, "file");
  if (points.targets.size() > 1) text += ", " + counted(points.targets.size(), "target point");
  return paragraph("points      ", text);
}

/// "4 ms"; "4.003 ms" where it is measured.
std::string cycle_text(std::chrono::nanoseconds cycle) {
  constexpr std::chrono::milliseconds kMillisecond(1);
  const bool whole = cycle % kMillisecond == std::chrono::nanoseconds(0);
  return fixed(std::chrono::duration<double, std::milli>(cycle).count(), whole ? 0 : 3) + " ms";
}

/// What noise hides where sweeps were recognised by positions alone.
std::string limit_text(const Outcome& outcome) {
  if (!outcome.motion_limit) return "";
  const auto& limit = *outcome.motion_limit;
  return paragraph(
      "noise       ",
      fmt::format("{:.4f} mm in each coordinate of a position, as the stream shows it: motion "
                  "slower than {:.1f} mm/s is taken for rest, arcs shorter than {:.1f} mm are not "
                  "used",
                  limit.noise_mm, limit.slowest_mm_s, limit.shortest_mm));
}

/// How a device's clock goes by the controller's, and what was made of both.
std::string clocks_text(const JoinedClocks& joined) {
  const auto& clock = joined.clock;
  std::string text = paragraph(
      "clocks      ",
      fmt::format("at {:.1f} s of the trace the device's shows {:.6f} s (+- {:.6f}) beyond the "
                  "controller's, and gains {:.2f} µs every second (+- {:.2f}), as {} show: at the "
                  "fastest sweep, {:.0f} mm/s, the uncertainty is {:.3f} mm along the way",
                  clock.at_s, clock.ahead_s, clock.sigma_s, 1e6 * clock.rate,
                  1e6 * clock.rate_sigma, counted(clock.matched, "motion"), joined.fastest_mm_s,
                  joined.fastest_mm_s * clock.sigma_s));
  if (joined.left_out_s > 0)
    text += paragraph(
        "            ",
        fmt::format("{:.1f} s of motion of several joints at once are left out: at 300 mm/s the "
                    "clocks would have to be known to 67 µs for 0.02 mm; rests between are used",
                    joined.left_out_s));
  return text;
}

std::string source_text(const Outcome& outcome) {
  if (outcome.joined) return points_text(*outcome.points) + clocks_text(*outcome.joined);
  if (outcome.points) return points_text(*outcome.points) + limit_text(outcome);
  if (is_given(outcome))
    return paragraph("axes        ",
                     fmt::format("{}, given as lines", outcome.identification.joints.size()));
  const auto& counts = outcome.counts;
  const auto& link = counts.link;
  std::string telegrams = std::to_string(link.telegrams);
  if (counts.cycle) telegrams += ", one every " + cycle_text(*counts.cycle);
  std::string late = link.late_replies
                         ? fmt::format("late at controller {}", *link.late_replies)
                         : "how many were late is not known: the telegrams carry no Delay";
  if (link.late_runs > 0)
    late +=
        fmt::format(", in {} of at most {}", counted(link.late_runs, "run"), link.longest_late_run);
  std::string text =
      paragraph("telegrams   ", telegrams) +
      paragraph(
          "link        ",
          fmt::format("lost {}, duplicated {}, reordered {}, malformed {}, restarts {}", link.lost,
                      link.duplicated, link.reordered, counts.malformed_in_all(), link.restarts)) +
      paragraph("replies     ", late);
  if (counts.unusable_values > 0)
    text += paragraph("values      ", fmt::format("{} were no numbers", counts.unusable_values));
  return text + limit_text(outcome);
}

std::string home_text(const Identification& found) {
  std::string text, unit;
  for (std::size_t j = 0; j < found.home_rad.size(); ++j) {
    if (!found.home_rad[j]) continue;
    const bool linear = j < found.joints.size() && found.joints[j].linear;
    const std::string of = linear ? " mm" : " deg";
    // One unit for all that have it, up to the next one.
    text += (text.empty() ? ""
             : of == unit ? ", "
                          : unit + ", ") +
            fmt::format("A{} {}", j + 1, fixed(degrees(*found.home_rad[j]), 3));
    unit = of;
  }
  return text.empty() ? text : paragraph("home        ", text + unit);
}

/// What the joints that turn, or those that are linear, swept.
std::string swept(const Identification& found, bool linear) {
  std::string text =
      linear ? "joint  sweeps  used  samples   way mm  across µm    bend µm   axis deg\n"
             : "joint  sweeps  used  samples  arc deg  radius mm  plane µm  radial µm   axis deg\n";
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const auto& joint = found.joints[j];
    if (joint.linear != linear) continue;
    std::size_t used = 0;
    std::size_t samples = 0;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      if (!joint.used[s]) continue;
      ++used;
      samples += joint.sweeps[s].samples->size();
    }
    text += right(std::to_string(j + 1), 5) + right(std::to_string(joint.sweeps.size()), 8) +
            right(std::to_string(used), 6) + right(std::to_string(samples), 9);
    if (joint.circle)
      text += number(degrees(joint.circle->arc_rad), 2, 9) +
              number(joint.circle->radius_mm, 3, 11) +
              number(1000 * joint.circle->plane_rms_mm, 2, 10) +
              number(1000 * joint.circle->radial_rms_mm, 2, 11);
    if (joint.line)
      text += number(joint.line->length_mm, 2, 9) +
              number(1000 * joint.line->across_rms_mm, 2, 11) +
              number(1000 * joint.line->bend_mm, 2, 11);
    if (joint.axis) text += number(degrees(joint.axis->direction_sigma_rad()), 7, 11);
    text += "\n";
  }
  return text;
}

std::string swept(const Identification& found) {
  const auto is_linear = [](const identify::JointResult& joint) { return joint.linear; };
  const auto linear = std::count_if(found.joints.begin(), found.joints.end(), is_linear);
  std::string text;
  if (linear < std::ssize(found.joints)) text += swept(found, false) + "\n";
  if (linear > 0) text += swept(found, true) + "\n";
  return text;
}

/// Of all points, and of each joint's: what a measuring device has to reach.
std::string boxes(const Identification& found) {
  std::string text =
      "Smallest box around the points: " + fixed(found.bounding_box->lengths_mm(0), 3) + " x " +
      fixed(found.bounding_box->lengths_mm(1), 3) + " x " +
      fixed(found.bounding_box->lengths_mm(2), 3) + " mm, " +
      fixed(found.bounding_box->volume_mm3() * 1e-9, 4) + " m3\n\n" + "joint" +
      right("length mm", 12) + right("width mm", 11) + right("height mm", 11) +
      right("centre x mm", 14) + right("y mm", 12) + right("z mm", 12) + "\n";
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    if (!found.joints[j].box) continue;
    const auto& box = *found.joints[j].box;
    text += right(std::to_string(j + 1), 5) + number(box.lengths_mm(0), 3, 12) +
            number(box.lengths_mm(1), 3, 11) + number(box.lengths_mm(2), 3, 11) +
            number(box.center_mm(0), 2, 14) + number(box.center_mm(1), 2, 12) +
            number(box.center_mm(2), 2, 12) + "\n";
  }
  return text;
}

std::string vector_text(const Eigen::Vector3d& v, int decimals) {
  return fixed(v.x(), decimals) + ", " + fixed(v.y(), decimals) + ", " + fixed(v.z(), decimals);
}

std::string delay_text(const identify::Delay& delay) {
  std::string text = std::string("the angles are ") + fixed(1e3 * std::abs(delay.late_s), 3) +
                     " ms " + (delay.late_s < 0 ? "early" : "late") + " (+- " +
                     fixed(1e3 * delay.sigma_s, 3) + ") against the positions";
  if (delay.rate != 0)
    text += ", which grows by " + fixed(1e6 * delay.rate, 2) + " µs every second";
  return text + ": they were shifted by it";
}

/// Where the target and, in a device's frame, the robot are; and when.
std::string places(const Identification& found) {
  std::string text;
  if (found.tool)
    text += paragraph("tool        ", vector_text(found.tool->translation(), 4) +
                                          " mm in the frame behind the last row" +
                                          (found.specified.empty() ? "" : " as specified"));
  if (found.robot_pose)
    text += paragraph("robot       ",
                      "base at " + vector_text(found.robot_pose->pose.translation(), 4) +
                          " mm (+- " + vector_text(found.robot_pose->position_sigma_mm, 4) +
                          ") in the device's frame");
  if (found.delay && is_significant(*found.delay))
    text += paragraph("delay       ", delay_text(*found.delay));
  return text;
}

}  // namespace

std::string report(const Outcome& outcome) {
  const Identification& found = outcome.identification;
  std::string status(identify::text(found.status));
  if (!found.reason.empty()) status += ": " + found.reason;
  std::string text;
  if (found.status != identify::Status::failed)
    text = paragraph("describes   ", explanation(outcome));
  text += paragraph("robot       ", outcome.robot) + paragraph("status      ", status);
  for (std::size_t i = 1; i < found.doubts.size(); ++i)
    text += paragraph("            ", "and " + found.doubts[i].message);
  text += source_text(outcome) + home_text(found) + "\n";
  const bool any_sweep = std::any_of(found.joints.begin(), found.joints.end(),
                                     [](const auto& joint) { return !joint.sweeps.empty(); });
  if (any_sweep) text += swept(found);
  if (found.poses) text += poses_text(*found.poses) + "\n";
  const bool any_axis =
      found.status != identify::Status::failed && (found.bounding_box || found.poses);
  if (any_axis || is_given(outcome)) text += dh_text(found);
  if (const std::string budget = budget_text(found); any_axis && !budget.empty())
    text += "\n" + budget;
  if (any_axis && found.chain) {
    text += "\n" + places(found);
    if (any_sweep) text += chain_text(*found.chain);
  }
  if (any_axis && found.bounding_box) text += "\n" + boxes(found);
  std::string warnings;
  for (const auto& warning : found.warnings)
    if (warning.message != found.reason)  // else the status has it
      warnings += paragraph("  - ", warning.message + " [" + warning.code + "]");
  return warnings.empty() ? text : text + "\nWarnings\n" + warnings;
}

std::string sweep_line(const identify::Sweep& sweep, std::optional<std::size_t> planned,
                       const std::vector<JointLimits>& limits) {
  std::string who = "a joint";
  if (planned) who = fmt::format("joint {} by the plan", *planned + 1);
  if (sweep.joint) who = fmt::format("joint {}", *sweep.joint + 1);
  const std::optional<std::size_t> joint = sweep.joint ? sweep.joint : planned;
  const bool linear = joint && *joint < limits.size() && limits[*joint].linear;
  return who + ": sweep of " +
         (sweep.direction > 0   ? "+"
          : sweep.direction < 0 ? "-"
                                : "") +
         fixed(degrees(sweep.range_rad), 1) + (linear ? " mm in " : " deg in ") +
         fixed(sweep.last().time_s - sweep.first().time_s, 2) + " s, " +
         counted(sweep.samples->size(), "sample");
}

}  // namespace sweepd
