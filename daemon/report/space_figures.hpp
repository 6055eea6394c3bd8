#pragma once

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// Figure 7 of the paper: all fitted circles drawn whole, with their centres and normals, the range
/// that was moved on each of them, the axes, and the arm's skeleton at home. From above, from the
/// front, from the side, and in perspective; circles too small to be seen beside the others have an
/// inset.
void add_axes_figure(Markup parent, const ReportFolder& folder);

/// Figures 3 and 4 of the paper for each joint: the circle with its centre and normal in the frame
/// of the measurements, and the points in the frame of their singular value decomposition (eq. 3),
/// whose axes are as long as the singular values.
void add_circle_figures(Markup parent, const ReportFolder& folder);

/// A figure with a caption: `title` in bold, then `text`.
[[nodiscard]] Markup add_figure(Markup parent, std::string_view title, std::string_view text);

}  // namespace sweepd
