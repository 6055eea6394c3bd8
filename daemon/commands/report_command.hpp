#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct ReportOptions {
  std::vector<std::filesystem::path> folders;
  std::optional<std::filesystem::path> facts;
  /// Nothing: report.html in the folder; of several folders report.html here.
  std::optional<std::filesystem::path> output;
  bool pdf = false;
  bool force = false;
};

/// Makes the measurement report of folders of results again, perhaps with facts, and as PDF beside
/// it. Says on `out` which files it wrote. Returns the exit code. Throws ConfigError and
/// std::runtime_error, and as Outputs where a file may not be written.
[[nodiscard]] int make_report(const ReportOptions& options, std::ostream& out = std::cout);

CLI::App* add_report(CLI::App& app, ReportOptions& options);

}  // namespace sweepd
