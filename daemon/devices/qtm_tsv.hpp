#pragma once

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

// Qualisys Track Manager, export to TSV of 3D and of 6DOF data. Source: QTM's manual, "Motion data
// (.tsv)" and "Rotation angles in QTM" (file version 2.0.0 and before), and a 6D file of the public
// project shiplab/dt_cv.
//
// The header has a name and its values in each line: FREQUENCY, DATA_INCLUDED, MARKER_NAMES or
// BODY_NAMES. Then comes perhaps a row that names the columns, then the data, with frame and time
// in front or without. Positions are in mm. A target that was not seen is empty, null, or at 0, 0,
// 0. A body has position, roll, pitch, yaw, residual, and its rotation matrix, column by column.

[[nodiscard]] bool is_qtm_tsv(const DeviceText& text);
[[nodiscard]] DeviceLayout qtm_layout(const DeviceText& text);

}  // namespace sweepd
