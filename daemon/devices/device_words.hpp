#pragma once

#include <string>
#include <string_view>

namespace sweepd {

/// What the name of a column says, as a person wrote it.
struct ColumnName {
  /// What the value is: "x", "y", "z"; "rx", "ry", "rz", "rw" of a quaternion; "time", "name",
  /// "group", "collection", "target"; empty where none of them.
  std::string value;
  std::string unit;  ///< lower case, without brackets; empty where none is told
};

/// "Measured X [mm]" is x in mm.
[[nodiscard]] ColumnName column_name(std::string_view text);

/// Whether it is "joint", or as "a1_deg" or "a12_rad" that of a joint's angle; in capitals or not.
[[nodiscard]] bool names_joint(std::string_view text);

/// What one of this unit of time is in seconds; 0 for anything else.
[[nodiscard]] double time_unit_s(std::string_view name);

}  // namespace sweepd
