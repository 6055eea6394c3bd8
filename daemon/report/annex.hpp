#pragma once

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// What somebody needs who checks the report: all numbers of dh.csv as they stand there, all forms
/// of the arm, the program, the inputs with their hashes, and the command that makes it again.
void add_annex(Markup parent, const ReportFolder& folder);

}  // namespace sweepd
