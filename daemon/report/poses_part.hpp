#pragma once

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// What static poses told: what is left at each level of correction, drawn and as a table, and what
/// joints do beside their angles. Nothing where the result has no poses.
void add_poses(Markup parent, const ReportFolder& folder);

}  // namespace sweepd
