#include "daemon/plan/plan_text.hpp"

#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "daemon/plan/outlook_numbers.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/models/kinematic_model.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::DhEstimate;
using identify::DhNumber;
using identify::Knowledge;

/// A number of a sweep; of a linear joint, under a heading of degrees, with its unit.
std::string of_sweep(const PlannedSweep& sweep, double value, int decimals, std::size_t width) {
  if (!sweep.linear) return number(value, decimals, width);
  return right(fixed(value, decimals) + (decimals == 2 ? " mm/s" : " mm"), width);
}

std::string sweeps_text(const PlanOutlook& outlook) {
  std::string text = "sweep  joint    from deg      to deg  speed deg/s   time s  samples  used\n";
  const Rehearsal& rehearsal = outlook.rehearsal;
  for (std::size_t s = 0; s < outlook.plan.sweeps.size(); ++s) {
    const PlannedSweep& sweep = outlook.plan.sweeps[s];
    text += right(std::to_string(s + 1), 5) + right(std::to_string(sweep.joint), 7) +
            of_sweep(sweep, sweep.start_deg, 3, 12) + of_sweep(sweep, sweep.end_deg, 3, 12) +
            of_sweep(sweep, sweep.speed_deg_s, 2, 13);
    const auto& stroke = rehearsal.stroke_of_sweep[s];
    if (!stroke) {
      text += right("-", 9) + right("-", 9) + right("no", 6) + "\n";
      continue;
    }
    const identify::Sweep& seen = rehearsal.strokes[*stroke];
    bool used = false;
    const auto& joint = rehearsal.identification.joints[sweep.joint - 1];
    for (std::size_t k = 0; k < joint.sweeps.size(); ++k)
      used = used || (joint.used[k] && joint.sweeps[k].samples == seen.samples);
    text += number(seen.last().time_s - seen.first().time_s, 2, 9) +
            right(std::to_string(seen.samples->size()), 9) + right(used ? "yes" : "no", 6) + "\n";
  }
  return text;
}

std::string verdict(AxisOutlook axis) {
  switch (axis) {
    case AxisOutlook::good:
      return "good";
    case AxisOutlook::near:
      return "target close to it";
    case AxisOutlook::vague:
      return "poorly determined";
    case AxisOutlook::lost:
      return "refused";
    case AxisOutlook::never_swept:
      return "never swept";
  }
  return "";
}

std::string axes_text(const PlanOutlook& outlook) {
  OutlookDecimals decimals;
  for (const auto& axis : outlook.prediction.axes) {
    if (!axis) continue;
    decimals.see(degrees(axis->direction_sigma_rad()));
    if (!axis->linear) decimals.see(axis->point_sigma_mm());
  }
  std::string text = "joint  target to axis mm  direction std unc deg  place std unc mm  verdict\n";
  for (std::size_t j = 0; j < outlook.axes.size(); ++j) {
    const auto& axis = outlook.prediction.axes[j];
    const bool placed = !axis || !axis->linear;  // a linear joint's axis has no place
    text +=
        right(std::to_string(j + 1), 5) +
        (placed ? number(outlook.prediction.radius_mm[j], 2, 19) : right("-", 19)) +
        (axis ? number(degrees(axis->direction_sigma_rad()), decimals.count(), 23)
              : right("-", 23)) +
        (axis && placed ? number(axis->point_sigma_mm(), decimals.count(), 18) : right("-", 18)) +
        "  " + verdict(outlook.axes[j]) + "\n";
  }
  return text;
}

std::string dh_text(const PlanOutlook& outlook) {
  std::string text = "DH parameters and the uncertainties to be expected\n\n" +
                     left("joint", kJointColumn) + right("specified", kValueColumn) +
                     right("std unc", kSigmaColumn) + right("95 % +-", kSigmaColumn) + "\n";
  const auto& specified = outlook.rehearsal.identification.specified;
  bool conventions = false;
  OutlookDecimals decimals;
  decimals.see(outlook.prediction.dh);
  for (std::size_t j = 0; j < outlook.prediction.dh.size(); ++j) {
    const DhEstimate& row = outlook.prediction.dh[j];
    for (const OutlookNumber& one : kOutlookNumbers) {
      if (!shown(one, row)) continue;
      const DhNumber& found = row.*one.number;
      conventions = conventions || found.knowledge == Knowledge::by_convention;
      const bool known = found.knowledge == Knowledge::identified;
      text += line_start(j, one) + number(specified_value(specified[j], one), 4, kValueColumn) +
              sigma_text(found, one, decimals.count(), kSigmaColumn) +
              (known ? sigma_text(found, one, decimals.count(), kSigmaColumn,
                                  identify::kSigmasOf95Percent)
                     : "") +
              "\n";
    }
    if (j + 1 < outlook.prediction.dh.size())
      text += "        to the next axis: " + std::string(identify::text(row.relation)) + "\n";
  }
  if (conventions) text += "(set): such data do not determine it; it is set by convention.\n";
  return text;
}

std::string measured_text(const Measurement& measurement) {
  const auto wobble = plain(measurement.wobble_deg);
  const auto cycle_ms = measurement.cycle.count();
  if (measurement.position_sigma_mm)
    return fmt::format(
        "by another device, to {} mm (sigma) a coordinate, a point every {} ms, no angles, joints "
        "wobble by {} deg (sigma)",
        plain(*measurement.position_sigma_mm), cycle_ms, wobble);
  return fmt::format(
      "by the controller, a telegram every {} ms, {}, joints wobble by {} deg (sigma)", cycle_ms,
      rsi::counted(static_cast<std::uint64_t>(measurement.precision), "decimal"), wobble);
}

}  // namespace

std::string plan_text(const RobotDescription& robot, const PlanOutlook& outlook,
                      const Measurement& measurement) {
  const Eigen::Vector3d& tool = outlook.rehearsal.campaign.specified->tool_mm;
  const double duration_s = std::chrono::duration<double>(outlook.rehearsal.duration).count();
  std::string text =
      paragraph("robot       ", robot.name) +
      paragraph("plan        ", fmt::format("{}: {}, takes {} s", outlook.plan.file.string(),
                                            rsi::counted(outlook.plan.sweeps.size(), "sweep"),
                                            fixed(duration_s, 1))) +
      paragraph("measured    ", measured_text(measurement)) +
      paragraph("target      ", fmt::format("{}, {}, {} mm in the frame behind the last row",
                                            plain(tool.x()), plain(tool.y()), plain(tool.z())));
  text += "\n" + sweeps_text(outlook) + "\n" + axes_text(outlook) + "\n" + dh_text(outlook);
  if (!outlook.warnings.empty()) {
    text += "\nWarnings\n";
    for (const auto& warning : outlook.warnings)
      text += paragraph("  - ", warning.message + " [" + warning.code + "]");
  }
  return text;
}

std::string proposal_text(const PlanOutlook& before, const Proposal& proposal, double margin_deg) {
  if (proposal.steps.empty())
    return "\nProposal\n" +
           paragraph(
               "  ",
               fmt::format("none: wider ranges within the joint limits, {} deg off each, would not "
                           "lower the uncertainties by 10 %, or the robot description has no "
                           "limits",
                           plain(margin_deg)));
  std::string text =
      "\nProposal: wider ranges, the sweep that helps most first\n\n"
      "joint    from deg      to deg      instead of                  uncertainties\n";
  for (const ProposedStep& step : proposal.steps) {
    const std::string instead = plain(step.before.start_deg) + " to " + plain(step.before.end_deg);
    text += right(std::to_string(step.after.joint), 5) +
            of_sweep(step.after, step.after.start_deg, 3, 12) +
            of_sweep(step.after, step.after.end_deg, 3, 12) + "      " + left(instead, 20) +
            (std::isfinite(step.gain) ? "  " + number(step.gain, 2, 8) + " times smaller"
                                      : "  more numbers determined") +
            "\n";
  }
  const double duration_s =
      std::chrono::duration<double>(proposal.outlook.rehearsal.duration).count();
  const double now_s = std::chrono::duration<double>(before.rehearsal.duration).count();
  text += "\n" + left("joint", kJointColumn) + right("std unc now", kValueColumn) +
          right("proposed", kSigmaColumn) + right("times smaller", 15) + "\n";
  OutlookDecimals decimals;
  decimals.see(before.prediction.dh);
  decimals.see(proposal.outlook.prediction.dh);
  for (std::size_t j = 0; j < before.prediction.dh.size(); ++j)
    for (const OutlookNumber& one : kOutlookNumbers) {
      const DhNumber& now = before.prediction.dh[j].*one.number;
      const DhNumber& then = proposal.outlook.prediction.dh[j].*one.number;
      if (!shown(one, before.prediction.dh[j]) && !shown(one, proposal.outlook.prediction.dh[j]))
        continue;
      text += line_start(j, one) + sigma_text(now, one, decimals.count(), kValueColumn) +
              sigma_text(then, one, decimals.count(), kSigmaColumn);
      if (now.sigma > 0 && then.sigma > 0) text += number(now.sigma / then.sigma, 2, 15);
      text += "\n";
    }
  text += "\n" +
          paragraph("takes       ",
                    fmt::format("{} s instead of {} s", fixed(duration_s, 1), fixed(now_s, 1))) +
          paragraph("CAUTION     ",
                    "sweepd knows the joint limits, but neither the cell, nor cables, nor the "
                    "robot's own body and tool: drive every new range by hand in T1 first");
  if (!proposal.outlook.warnings.empty()) {
    text += "\nWarnings about the proposed plan\n";
    for (const auto& warning : proposal.outlook.warnings)
      text += paragraph("  - ", warning.message + " [" + warning.code + "]");
  }
  return text;
}

}  // namespace sweepd
