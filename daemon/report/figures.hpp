#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

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

/// Figure 8 of the paper: the points of all joints of each folder, each joint's in its smallest box
/// and all of them in theirs; below them Table 4, the boxes' lengths, volume and orientation.
void add_range_figure(Markup parent, std::span<const ReportFolder> folders);

/// For each joint: residuals off its plane and off its circle, and the error of its angle with the
/// part of it that repeats, all over the joint's angle, with bands of two root mean squares.
void add_residual_figures(Markup parent, const ReportFolder& folder);

/// What each number's variance comes from, as bars.
void add_budget_figure(Markup parent, const ReportFolder& folder);

/// Latency of the replies and jitter of the telegrams, as histograms beside the cycle.
void add_link_figure(Markup parent, const ReportFolder& folder);

/// When which joint swept.
void add_time_figure(Markup parent, const ReportFolder& folder);

/// Motor current of each joint over its angle, rising and falling, and its friction: half the
/// difference. Nothing where the folder has no currents.csv.
void add_currents(Markup parent, const ReportFolder& folder);

/// From the specification to what was identified, over the workspace: three slices of
/// displacement.csv. Nothing where the folder has none.
void add_displacement(Markup parent, const ReportFolder& folder);

/// One of the slices, across X, Y or Z (0, 1, 2), as an SVG file that stands alone. Empty where the
/// CSV has none.
[[nodiscard]] std::string displacement_svg(std::string_view displacement_csv, std::size_t across);

}  // namespace sweepd
