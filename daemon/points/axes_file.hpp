#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "identify/dh/dh_extraction.hpp"

namespace sweepd {

/// Reads joint axes, one a line: a point of it and its direction, of any length, joint 1 to n in
/// any order. Their covariance is zero unless the file states standard uncertainties. `columns`
/// take the place of the header unless empty; `joints` is the most that there may be.
///
/// Throws CsvError, and std::invalid_argument where `columns` are wrong.
[[nodiscard]] std::vector<identify::Axis> read_axes(const std::filesystem::path& path,
                                                    const std::vector<std::string>& columns,
                                                    std::size_t joints);

/// The columns that read_axes() knows, for a manual.
inline constexpr std::string_view kAxisColumns =
    "joint, x_mm, y_mm, z_mm (or x_m ...), dx, dy, dz, and perhaps direction_sigma_deg, "
    "point_sigma_mm";

}  // namespace sweepd
