#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "daemon/results/correction.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct CorrectOptions {
  std::filesystem::path result;
  CorrectionLevel level = CorrectionLevel::mastering;
  std::optional<std::filesystem::path> program;  ///< of targets: P.dat
  std::optional<std::filesystem::path> write;    ///< and where it goes, corrected
  std::optional<std::filesystem::path> config;   ///< $CONFIG.DAT
  std::string base;                              ///< frames as in KRL; empty: not given
  std::string tool;
  std::string flange;
  double largest_shift_mm = 3;
  std::vector<std::string> leave;
  std::optional<std::filesystem::path> output;  ///< correction.json beside `result`
  bool force = false;
};

/// Adds the command with its options.
CLI::App* add_correct(CLI::App& app, CorrectOptions& options);

/// Says what a result corrects, and writes a corrected program. The text goes to `out`,
/// correction.json to its place. Returns the exit code. Throws std::invalid_argument where options
/// do not go together, and std::runtime_error where the result or the program is refused; then
/// nothing is written.
[[nodiscard]] int correct(const CorrectOptions& options, std::ostream& out = std::cout);

}  // namespace sweepd
