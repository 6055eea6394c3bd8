#pragma once

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// Figure 7 of the paper: all fitted circles drawn whole, with their centres and normals, the range
/// that was moved on each of them, the axes, and the arm's skeleton at home. From above, from the
/// front, from the side, and in perspective; circles too small to be seen beside the others have an
/// inset.
void add_axes_figure(Markup parent, const ReportFolder& folder);

}  // namespace sweepd
