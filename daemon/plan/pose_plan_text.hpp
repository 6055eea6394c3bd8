#pragma once

#include <string>

#include "daemon/plan/pose_plan.hpp"

namespace sweepd {

/// How poses were chosen, what they will tell beside poses drawn blindly, what stays open.
[[nodiscard]] std::string pose_plan_text(const RobotDescription& robot, const PosePlan& plan);

}  // namespace sweepd
