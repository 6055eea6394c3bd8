#include "daemon/plan/plan_outlook.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "daemon/settings/toml_table.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/advice.hpp"
#include "identify/geometry/line.hpp"

namespace sweepd {
namespace {

using identify::SweepDefect;

/// Advice about the plan; other advice is about what went wrong in measuring.
constexpr std::array<std::string_view, 9> kOfPlan{
    "arc_short",       "stroke_short",      "range_unbalanced", "speed_high",     "low_precision",
    "sweep_too_short", "joint_never_moved", "target_near_axis", "angles_not_used"};

/// What to change in the plan's sweep.
std::string_view change(SweepDefect defect, bool linear) {
  switch (defect) {
    case SweepDefect::too_short:
      if (linear) return "it is shorter than 5 mm: move the joint further";
      return "it is shorter than 5 degrees: sweep the joint further";
    case SweepDefect::too_few_samples:
      return "it has too few samples: move the joint slower";
    default:
      return "it is too short or too fast to be told from rest: sweep the joint further, slower";
  }
}

class Judge {
 public:
  Judge(const RobotDescription& robot, PlanOutlook& outlook) : robot_(robot), outlook_(outlook) {}

  void run() {
    for (std::size_t s = 0; s < outlook_.plan.sweeps.size(); ++s) judge_sweep(s);
    for (std::size_t j = 0; j < robot_.joints(); ++j) outlook_.axes.push_back(judge_axis(j));
    for (const identify::Warning& warning : outlook_.rehearsal.identification.warnings) {
      const bool told = warning.joint && outlook_.axes[*warning.joint] == AxisOutlook::lost;
      if (!told && std::find(kOfPlan.begin(), kOfPlan.end(), warning.code) != kOfPlan.end())
        outlook_.warnings.push_back(warning);
    }
  }

 private:
  void judge_sweep(std::size_t s) {
    const PlannedSweep& sweep = outlook_.plan.sweeps[s];
    const Rehearsal& rehearsal = outlook_.rehearsal;
    const auto stroke = rehearsal.stroke_of_sweep[s];
    const auto defect = stroke ? rehearsal.strokes[*stroke].defect : SweepDefect::none;
    const auto what =
        fmt::format("sweep {} (joint {}, {} to {} {})", s + 1, sweep.joint,
                    number_text(sweep.start_deg), number_text(sweep.end_deg), sweep.unit());
    if (!stroke || defect != SweepDefect::none) {
      outlook_.refusals.push_back(
          fmt::format("{} would not be used: {}", what, change(defect, sweep.linear)));
      return;
    }
    const auto& joint = rehearsal.identification.joints[sweep.joint - 1];
    for (std::size_t k = 0; k < joint.sweeps.size(); ++k)
      if (joint.sweeps[k].samples == rehearsal.strokes[*stroke].samples && !joint.used[k])
        outlook_.warnings.push_back(
            {"sweep_not_used", sweep.joint - 1,
             what +
                 " touches home at one end, where the joint has others that do not: it is taken "
                 "for the way to one of them and not used; let all of them begin and end at "
                 "least 1 " +
                 (sweep.linear ? "mm" : "degree") + " off home, or all touch it"});
  }

  AxisOutlook judge_axis(std::size_t j) {
    const bool swept = std::any_of(outlook_.plan.sweeps.begin(), outlook_.plan.sweeps.end(),
                                   [&](const PlannedSweep& sweep) { return sweep.joint == j + 1; });
    if (!swept) return AxisOutlook::never_swept;
    const auto& axis = outlook_.prediction.axes[j];
    const double radius_mm = outlook_.prediction.radius_mm[j];
    const bool near = !robot_.limits[j].linear && radius_mm < identify::kNearAxis_mm;
    const bool poor = !axis || axis->direction_sigma_rad() > identify::kPoorDirection_rad;
    if (!poor) return near ? AxisOutlook::near : AxisOutlook::good;
    if (axis && !near) return AxisOutlook::vague;
    const std::string uncertain = axis ? fmt::format("its direction would be uncertain by {} deg",
                                                     fixed(degrees(axis->direction_sigma_rad()), 2))
                                       : "it would not be determined";
    const std::string why =
        near ? fmt::format(
                   "the target point is {} mm from its axis, and {}: choose a tool point "
                   "100 mm or more off axis {} (--tool-mm, or tool_mm of the robot "
                   "description)",
                   fixed(radius_mm, 2), uncertain, j + 1)
        : robot_.limits[j].linear ? "its direction would not be determined: move it further"
                                  : "its axis would not be determined: sweep it further";
    outlook_.refusals.push_back(fmt::format("joint {}: {}", j + 1, why));
    return AxisOutlook::lost;
  }

  const RobotDescription& robot_;
  PlanOutlook& outlook_;
};

}  // namespace

PlanOutlook look_ahead(const RobotDescription& robot, const SweepPlan& plan,
                       const Measurement& measurement, std::uint64_t rehearsals) {
  PlanOutlook outlook;
  outlook.plan = plan;
  outlook.rehearsal = rehearse(robot, plan, measurement);
  std::vector<identify::Prediction> predictions{outlook.rehearsal.prediction(measurement)};
  // Another device's noise is given: there nothing depends on how a rehearsal turned out.
  if (!measurement.position_sigma_mm)
    for (std::uint64_t seed = 2; seed <= rehearsals; ++seed)
      predictions.push_back(rehearse(robot, plan, measurement, seed).prediction(measurement));
  outlook.prediction = identify::mean(predictions);
  Judge(robot, outlook).run();
  return outlook;
}

}  // namespace sweepd
