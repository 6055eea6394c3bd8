#pragma once

#include "daemon/points/points_file.hpp"

namespace sweepd {

/// Of a file with joint angles, and with neither times nor a column joint: whether its lines are
/// sweeps, since in most of them one joint alone has moved from the lines before. If so, each point
/// is given the joint and a number of the sweep; those that belong to none are taken out.
[[nodiscard]] bool find_sweeps_by_angles(PointsFile& file, double angle_step_rad);

}  // namespace sweepd
