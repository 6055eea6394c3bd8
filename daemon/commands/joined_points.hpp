#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/points/points_file.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/settings/robot_setup.hpp"

namespace sweepd {

/// The points of a device with the angles of a trace that was recorded meanwhile. Throws CsvError
/// where the points cannot be joined with anything: no times, or angles of their own; and
/// rsi::CaptureError, std::runtime_error where the traces hold no angles.
[[nodiscard]] Outcome joined_with_trace(const std::vector<PointsFile>& files,
                                        const identify::Resolution& resolution,
                                        const std::vector<std::string>& targets,
                                        const std::vector<std::filesystem::path>& traces,
                                        const RobotSetup& setup, bool quiet);

}  // namespace sweepd
