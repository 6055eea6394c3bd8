#pragma once

#include <cstddef>
#include <vector>

#include "daemon/points/points_file.hpp"

namespace sweepd {

/// Some programs print a joint's angle from 0 to 360 degrees, or from -180 to 180: where the joint
/// passes the end, it jumps by a turn. Of each joint whose angle jumps so within a sweep or a
/// stream, the turns are taken out in all `files`, as far as they leave open a part of the circle
/// where it never is; and of the others where angles go from 0 to 360, so that all lie about 0.
/// Linear joints are left as they are. Returns the joints that jumped, from 0.
std::vector<std::size_t> take_out_turns(std::vector<PointsFile>& files);

}  // namespace sweepd
