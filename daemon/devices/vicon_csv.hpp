#pragma once

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

// Vicon Nexus ("Export ASCII") and Vicon Tracker, CSV or with semicolons. Source: files of both
// programs in public projects and their readers: ccu.uni-konstanz.de (Nexus, Tracker trajectories),
// ic.unicamp.br/~stolfi (Nexus), readers of Tracker's RX, RY, RZ, RW.
//
// A file has sections with an empty line between. Each has its name (Trajectories, Objects,
// Segments), its rate in Hz, the targets' names, the names of the columns (Frame, Sub Frame, X, Y,
// Z or RX ... TX ...), units, and the data; frames are turned into times by the rate. Trajectories
// are taken, or else Objects, or else Segments. RX, RY, RZ, RW are a quaternion. RX, RY, RZ alone
// may be Euler angles or a helical axis: the file does not tell, so they are left out. Markers that
// Nexus numbers ("*12") are left out where others have names.

[[nodiscard]] bool is_vicon_csv(const DeviceText& text);
[[nodiscard]] DeviceLayout vicon_layout(const DeviceText& text);

}  // namespace sweepd
