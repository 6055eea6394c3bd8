#pragma once

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

// OptiTrack Motive, "Export Tracking Data" as CSV, format versions 1.2 to 1.25 (Motive 1.9 to 3.x).
// Source: OptiTrack's documentation, "Data Export: CSV" (Motive 2.1, 3.0, 3.1), and its knowledge
// base, "Changes in Motive's Reported Euler Angles".
//
// The first line has metadata in pairs: Length Units, Export Frame Rate, Rotation Type. Then come
// rows of type, name, ID, perhaps parent, and of what a column is, until the one that begins with
// Frame. Empty cells were not seen. Quaternions are X, Y, Z, W. Angles turn about the body's own
// axes in the order that Rotation Type names.
//
// Targets are the labelled markers as they were seen, and rigid bodies without three markers in the
// file. Left out are bodies with them (their poses are made of these), markers as a body's model
// has them ("Rigid Body Marker": they stand still where nothing was seen), skeletons, and markers
// without a label where there are others.

[[nodiscard]] bool is_motive_csv(const DeviceText& text);
[[nodiscard]] DeviceLayout motive_layout(const DeviceText& text);

}  // namespace sweepd
