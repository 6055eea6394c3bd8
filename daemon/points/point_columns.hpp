#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/points/csv_file.hpp"

namespace sweepd {

/// Where in a line a value stands, and what one of its units is in mm, radians or seconds.
struct Place {
  std::size_t column = 0;
  double unit = 1;
};

/// What the columns of a file of measured points mean.
struct PointColumns {
  std::optional<Place> joint;
  std::optional<Place> target;
  std::optional<Place> sweep;
  std::optional<Place> time;
  std::array<Place, 3> position;
  std::optional<std::array<Place, 3>> abc;
  std::optional<std::array<Place, 4>> quaternion;  ///< x, y, z, w
  std::vector<Place> angles;                       ///< of joint 1 and on
};

/// Reads the names of the columns. Throws as CsvFile::fail_header does: at a name that is not
/// known, that comes twice, or that is missing.
[[nodiscard]] PointColumns point_columns(const CsvFile& file);

/// A name without its unit ("x" of "x_m"), and what that is in mm, radians or seconds; 1 where the
/// name has none.
struct NameAndUnit {
  std::string_view name;
  std::string_view unit;
  double size = 1;
};
[[nodiscard]] NameAndUnit name_and_unit(std::string_view column);

/// The names that point_columns() knows, for a manual.
inline constexpr std::string_view kPointColumns =
    "joint, target, t_s, x_mm, y_mm, z_mm (or x_m ...), qx, qy, qz, qw (quaternion of the tool) or "
    "a_deg, b_deg, c_deg (KUKA's A, B, C), a1_deg to a12_deg (or a1_rad ...)";

}  // namespace sweepd
