#pragma once

#include <string>

#include "daemon/plan/krl_writer.hpp"
#include "daemon/plan/pose_plan.hpp"

namespace sweepd {

/// What of `plan` or `options` KRL cannot express, as krl_findings().
[[nodiscard]] std::vector<std::string> krl_findings(const PosePlan& plan,
                                                    const KrlOptions& options);

/// The program that drives the poses: home, each pose and a rest, home. It streams positions by RSI
/// only where `options` names an RSI file. Throws std::invalid_argument with the first finding.
[[nodiscard]] KrlProgram krl_program(const PosePlan& plan, const KrlOptions& options);

/// A file of static poses for `identify`: a line for each, its angles told, its position empty.
[[nodiscard]] std::string pose_table(const PosePlan& plan);

}  // namespace sweepd
