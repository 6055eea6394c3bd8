#pragma once

#include "daemon/plan/krl_writer.hpp"
#include "daemon/settings/sweep_plan.hpp"

namespace sweepd {

/// The program that runs the plan's sweeps as the simulator does: home, RSI on; for each sweep to
/// its start, rest, sweep, rest, home; RSI off. Axis targets only, no approximation, $BASE is
/// $NULLFRAME; nothing of it corrects the path. KRL knows accelerations in per cent alone: 30 of
/// what the axes can do, whatever the plan says. Deterministic. Throws std::invalid_argument with
/// the first finding.
[[nodiscard]] KrlProgram krl_program(const SweepPlan& plan, const KrlOptions& options);

}  // namespace sweepd
