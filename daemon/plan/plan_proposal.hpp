#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "daemon/plan/plan_outlook.hpp"

namespace sweepd {

/// The joint's longest sweep made as wide as its limits allow, `margin_deg` off each, in the same
/// direction: at most 340 degrees, then about the middle of the old one, and the old one always
/// inside. The same plan where the limits are not known, or nothing can be gained.
[[nodiscard]] SweepPlan widened(const SweepPlan& plan, std::size_t joint,
                                const RobotDescription& robot, double margin_deg);

/// One joint's sweep, widened.
struct ProposedStep {
  PlannedSweep before;
  PlannedSweep after;
  double gain = 1;  ///< how many times smaller uncertainties become, geometric mean
};

struct Proposal {
  std::vector<ProposedStep> steps;  ///< the one that helps most first
  PlanOutlook outlook;              ///< of the proposed plan
};

/// How many times smaller the uncertainties of `after` are, in the geometric mean over the numbers
/// that both determine; infinite if it determines more of them.
[[nodiscard]] double gain(const identify::Prediction& before, const identify::Prediction& after);

/// Widens the sweep of one joint at a time, that which gains most, as long as a step gains 10 %.
/// Deterministic. `progress` is told how much is done, of how much at most.
[[nodiscard]] Proposal propose(const RobotDescription& robot, const PlanOutlook& from,
                               const Measurement& measurement, double margin_deg,
                               const std::function<void(double done, double total)>& progress = {});

}  // namespace sweepd
