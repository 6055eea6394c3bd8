#pragma once

#include <string>

#include "daemon/results/outcome.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {

/// robot.urdf of a model in the form `urdf`: links base_link (the measurement frame), link_1 ...
/// link_n, and tool0 at the target point; metres, radians, full precision. A joint's value is the
/// controller's angle; where its home is not known, the angle from home. The identified numbers
/// stand in the origins, where every reader looks; `calibration` tags are not used. A joint with
/// known limits and home is revolute, others are continuous; a linear one is prismatic, in metres,
/// its limits the description's or the range that was swept, for URDF demands some. Velocity limits
/// are the description's, 0 where it has none. What is no printable ASCII in the robot's name
/// becomes `_`.
[[nodiscard]] std::string urdf(const identify::KinematicModel& model, const Outcome& outcome);

}  // namespace sweepd
