#pragma once

#include <span>

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// Figure 8 of the paper: the points of all joints of each folder, each joint's in its smallest box
/// and all of them in theirs; below them Table 4, the boxes' lengths, volume and orientation.
void add_range_figure(Markup parent, std::span<const ReportFolder> folders);

}  // namespace sweepd
