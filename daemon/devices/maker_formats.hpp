#pragma once

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

// Tables with a line for each point, as programs of laser trackers and measuring arms write them:
// SpatialAnalyzer, PolyWorks, Leica (T-Mac, AT9x0), FARO CAM2. Users choose their columns, so the
// columns are known by their names: X, Y, Z with or without a unit ("X (mm)", "Measured X"), Q0 to
// Q3 (w first) or QX ... QW, Time, Timestamp, Date, Name, Group, Collection, Reflector. What has
// another name is passed over.
//
// Source: SpatialAnalyzer's manual, "Exporting ASCII Formatted Points" (names of collection, group
// and target, coordinates, then options; // before comments; blanks or commas), exported files of
// the public project FinnLinxxx/akig; manuals of PolyWorks and CAM2 leave the columns to the user.
//
// Without names of columns, SpatialAnalyzer's order counts: names, x, y, z, more. Units stand in
// the names of columns, in a row below, or in a line with the word unit; else millimetres are
// assumed, and said to be.
//
// A group that is named as a joint ("Joint 3", "A3") tells which joint moves; other groups are
// targets, and so are reflectors. Points without a group are of one target, unless the same names
// come again and again. Date and time count where points are dense enough to be a stream.

[[nodiscard]] bool is_spatial_analyzer_text(const DeviceText& text);
[[nodiscard]] bool is_polyworks_text(const DeviceText& text);
[[nodiscard]] bool is_leica_csv(const DeviceText& text);
[[nodiscard]] bool is_faro_csv(const DeviceText& text);
/// Of no known maker; units or a quaternion tell it from sweepd's own columns.
[[nodiscard]] bool is_tracker_table(const DeviceText& text);

[[nodiscard]] DeviceLayout tracker_layout(const DeviceText& text);

}  // namespace sweepd
