#pragma once

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// Figures 3 and 4 of the paper for each joint: the circle with its centre and normal in the frame
/// of the measurements, and the points in the frame of their singular value decomposition (eq. 3),
/// whose axes are as long as the singular values.
void add_circle_figures(Markup parent, const ReportFolder& folder);

}  // namespace sweepd
