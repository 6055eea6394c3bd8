#pragma once

#include <string>
#include <vector>

#include "daemon/plan/rehearsal.hpp"

namespace sweepd {

/// What can be said of a joint's axis before the robot moves.
enum class AxisOutlook {
  good,
  near,   ///< the target is close to it; it will be determined all the same
  vague,  ///< it will be found, but so badly that the result deserves a warning
  lost,   ///< it will not be found, or too badly to be of use: the plan is refused
  never_swept,
};

/// A plan, looked at before the robot runs it.
struct PlanOutlook {
  SweepPlan plan;
  Rehearsal rehearsal;
  identify::Prediction prediction;
  std::vector<AxisOutlook> axes;            ///< one a joint
  std::vector<std::string> refusals;        ///< why the plan must not be run, and what to do
  std::vector<identify::Warning> warnings;  ///< what could be better
};

/// Rehearses the plan and judges what it will bring. A plan is refused where an axis that it sweeps
/// would not be found, where the target is near an axis whose direction would be uncertain by more
/// than `identify::kPoorDirection_rad`, and where a sweep would not be recognised. Throws as
/// SimulatedRobot does, with all findings about limits.
///
/// The prediction is the mean over so many `rehearsals`: of one, an uncertainty is itself uncertain
/// by some 3 %.
[[nodiscard]] PlanOutlook look_ahead(const RobotDescription& robot, const SweepPlan& plan,
                                     const Measurement& measurement, std::uint64_t rehearsals = 6);

}  // namespace sweepd
