#pragma once

#include <cstddef>
#include <vector>

#include "daemon/points/points_file.hpp"
#include "identify/poses/pose.hpp"

namespace sweepd {

/// Whether each line is a static pose: the file says so, or has angles and nothing that would make
/// sweeps of its lines.
[[nodiscard]] bool holds_poses(const PointsFile& file);

/// The lines as static poses, named after file and line; those without a position or an angle are
/// passed over. Throws CsvError where the file has not the angles of all joints.
[[nodiscard]] std::vector<identify::Pose> static_poses(const PointsFile& file, std::size_t joints);

}  // namespace sweepd
