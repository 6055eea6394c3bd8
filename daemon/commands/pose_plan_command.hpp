#pragma once

#include <iostream>

#include "daemon/commands/plan_command.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace sweepd {

/// Adds those options of `sweepd plan` that are of static poses alone: they need `count`, which is
/// --poses.
void add_pose_options(CLI::App& command, PoseTask& poses, CLI::Option& count);

/// `sweepd plan --poses`: chooses poses, says what they will tell, writes their table and, where a
/// dialect is named, the program that drives them. Returns 0. Throws as plan_poses() and, for
/// files, as plan().
[[nodiscard]] int plan_static_poses(const PlanOptions& options, std::ostream& out = std::cout);

}  // namespace sweepd
