#pragma once

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// Motor current of each joint over its angle, rising and falling, and its friction: half the
/// difference. Nothing where the folder has no currents.csv.
void add_currents(Markup parent, const ReportFolder& folder);

}  // namespace sweepd
