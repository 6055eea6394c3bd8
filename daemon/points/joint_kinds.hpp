#pragma once

#include <vector>

#include "daemon/settings/robot_setup.hpp"

namespace sweepd {

/// What is known of a joint before its points are read.
enum class JointKind { unknown, turning, linear };

/// Of kMostJoints joints, what the description says or, without one, the plan.
[[nodiscard]] std::vector<JointKind> joint_kinds(const RobotSetup& setup);

}  // namespace sweepd
