#pragma once

#include <cstddef>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct IdentifyOptions {
  std::vector<std::filesystem::path> points;  ///< either these,
  std::optional<std::filesystem::path> axes;  ///< or this
  std::string columns;                        ///< names with commas between; empty: the header's
  std::string format;                         ///< of all files of points; empty: as each tells
  bool list_formats = false;                  ///< nothing else is done
  bool per_joint = false;                     ///< one file of points a joint, in their order
  bool poses = false;                         ///< each line is a static pose
  std::vector<std::filesystem::path> angles;  ///< traces of the controller, beside the points
  std::optional<std::filesystem::path> robot;
  std::optional<std::filesystem::path> plan;
  std::optional<std::size_t> joints;  ///< where neither robot nor plan tells
  bool device_frame = true;           ///< points are not in the robot's own frame
  std::optional<std::filesystem::path> output;
  bool quiet = false;                       ///< no progress, no report
  bool force = false;                       ///< over any files but those that are read
  std::vector<std::string> arguments = {};  ///< as it was called, for run.json
};

/// Identifies from points that another device than the controller measured, or takes axes as lines,
/// and writes what a replay writes. The report goes to `report`. Returns the exit code: 1 if not
/// one axis was identified, 3 if the result is doubtful. Throws CsvError, ConfigError,
/// std::invalid_argument for options that contradict each other and as Outputs where results may
/// not be written, and std::runtime_error.
[[nodiscard]] int identify_points(const IdentifyOptions& options, std::ostream& report = std::cout,
                                  std::ostream& errors = std::cerr);

CLI::App* add_identify(CLI::App& app, IdentifyOptions& options);  // identify_options.cpp

}  // namespace sweepd
