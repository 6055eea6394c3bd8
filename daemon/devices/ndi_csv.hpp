#pragma once

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

// NDI ToolBox (Polaris, Aurora), tracking data as CSV, and NDI First Principles (Optotrak), text
// with tabs or commas. Source: a file of ToolBox as a public reader of it has it (columns, states,
// -3.697314E28 for what was not measured), NDI's Combined API for the quaternion's order, and the
// exported file of the public project otaithleigh/optotrak (First Principles).
//
// ToolBox: one row names the columns. A tool begins with Port, then Frame, perhaps Time [sec],
// Face, State, Q0 (w), Qx, Qy, Qz, Tx, Ty, Tz in mm, Error, Markers, and State, Tx, Ty, Tz of each
// marker. What has another state than OK was not measured. Without times, frames count sixtieths of
// a second, as Polaris counts them. Markers of a tool are targets where there are three or more,
// the tool else.
//
// First Principles: Number of frames, Frequency and Units, an empty line, then Frame and NAME x,
// NAME y, NAME z of each marker, or NAME q0, qx, qy, qz too.

[[nodiscard]] bool is_ndi_csv(const DeviceText& text);
[[nodiscard]] DeviceLayout ndi_layout(const DeviceText& text);

}  // namespace sweepd
