#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// From the specification to what was identified, over the workspace: three slices of
/// displacement.csv. Nothing where the folder has none.
void add_displacement(Markup parent, const ReportFolder& folder);

/// One of the slices, across X, Y or Z (0, 1, 2), as an SVG file that stands alone. Empty where the
/// CSV has none.
[[nodiscard]] std::string displacement_svg(std::string_view displacement_csv, std::size_t across);

}  // namespace sweepd
