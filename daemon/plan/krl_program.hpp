#pragma once

#include <string>

#include "daemon/plan/krl_writer.hpp"
#include "daemon/plan/pose_plan.hpp"
#include "daemon/settings/sweep_plan.hpp"

namespace sweepd {

/// The program that runs the plan's sweeps as the simulator does: home, RSI on; for each sweep to
/// its start, rest, sweep, rest, home; RSI off. Axis targets only, no approximation, $BASE is
/// $NULLFRAME; nothing of it corrects the path. KRL knows accelerations in per cent alone: 30 of
/// what the axes can do, whatever the plan says. Deterministic. Throws std::invalid_argument with
/// the first finding.
[[nodiscard]] KrlProgram krl_program(const SweepPlan& plan, const KrlOptions& options);

/// What of `plan` or `options` KRL cannot express, as krl_findings().
[[nodiscard]] std::vector<std::string> krl_findings(const PosePlan& plan,
                                                    const KrlOptions& options);

/// The program that drives the poses: home, each pose and a rest, home. It streams positions by RSI
/// only where `options` names an RSI file. Throws std::invalid_argument with the first finding.
[[nodiscard]] KrlProgram krl_program(const PosePlan& plan, const KrlOptions& options);

/// A file of static poses for `identify`: a line for each, its angles told, its position empty.
[[nodiscard]] std::string pose_table(const PosePlan& plan);

}  // namespace sweepd
