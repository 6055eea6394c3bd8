#pragma once

#include <string>

#include "daemon/plan/plan_proposal.hpp"
#include "daemon/plan/pose_plan.hpp"

namespace sweepd {

/// What a plan will do and bring, for people: sweeps, target and axes, DH table with the standard
/// uncertainties to be expected, warnings.
[[nodiscard]] std::string plan_text(const RobotDescription& robot, const PlanOutlook& outlook,
                                    const Measurement& measurement);

/// Better ranges, and each number's uncertainty before and after.
[[nodiscard]] std::string proposal_text(const PlanOutlook& before, const Proposal& proposal,
                                        double margin_deg);

/// How poses were chosen, what they will tell beside poses drawn blindly, what stays open.
[[nodiscard]] std::string pose_plan_text(const RobotDescription& robot, const PosePlan& plan);

}  // namespace sweepd
