#pragma once

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// For each joint: residuals off its plane and off its circle, and the error of its angle with the
/// part of it that repeats, all over the joint's angle, with bands of two root mean squares.
void add_residual_figures(Markup parent, const ReportFolder& folder);

/// What each number's variance comes from, as bars.
void add_budget_figure(Markup parent, const ReportFolder& folder);

/// Latency of the replies and jitter of the telegrams, as histograms beside the cycle.
void add_link_figure(Markup parent, const ReportFolder& folder);

/// When which joint swept.
void add_time_figure(Markup parent, const ReportFolder& folder);

}  // namespace sweepd
