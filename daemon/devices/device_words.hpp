#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sweepd {

// What words in such files mean: names of columns, units, dates.

/// What the name of a column says, as a person wrote it.
struct ColumnName {
  /// What the value is: "x", "y", "z"; "rx", "ry", "rz", "rw" of a quaternion; "time", "name",
  /// "group", "collection", "target"; empty where none of them.
  std::string value;
  std::string unit;  ///< lower case, without brackets; empty where none is told
};

/// "Measured X [mm]" is x in mm.
[[nodiscard]] ColumnName column_name(std::string_view text);

/// Whether it is "joint", or as "a1_deg", "a12_rad", "A3" or "A4 [deg]" that of a joint's angle; in
/// capitals or not.
[[nodiscard]] bool names_joint(std::string_view text);

/// What one of this unit of time is in seconds; 0 for anything else.
[[nodiscard]] double time_unit_s(std::string_view name);

/// The same of a time that is told without a unit: seconds since 1970 have ten digits.
[[nodiscard]] double time_unit_of_count_s(double first);

/// Seconds, from a moment that all dates share, of a date with a time of day:
/// 2024-03-14T13:22:33.5, 3/14/2024 1:22:33.5 PM, 14.03.2024 13:22:33,5. Seconds from midnight
/// where there is no date. With slashes the month is first, unless it cannot be one. Time zones
/// count. Nothing for anything else.
[[nodiscard]] std::optional<double> seconds_of_date(std::string_view text);

}  // namespace sweepd
