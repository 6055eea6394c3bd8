#pragma once

#include <optional>

#include "daemon/devices/device_formats.hpp"
#include "daemon/points/points_file.hpp"

namespace sweepd {

/// The points of a device's file, of an arm with at most `joints`. Names of targets are added to
/// `targets`, and `step_mm` becomes the last decimal of positions if that is finer. What was not
/// measured gives no point. Throws CsvError.
[[nodiscard]] PointsFile device_points(const DeviceFormat& format, const DeviceText& text,
                                       std::size_t joints, TargetNames& targets,
                                       std::optional<double>& step_mm,
                                       const OnBytesRead& on_progress);

}  // namespace sweepd
