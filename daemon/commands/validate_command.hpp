#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct ValidateOptions {
  std::filesystem::path result;
  std::vector<std::filesystem::path> points;
  std::string columns;                          ///< names with commas between; empty: the header's
  std::optional<std::filesystem::path> output;  ///< validation.json in `result`
  bool force = false;
};

/// Judges a result of static poses by others. The text goes to `out`, validation.json to its place.
/// Returns the exit code. Throws CsvError, and std::runtime_error where the result has no poses or
/// was made of these.
[[nodiscard]] int validate(const ValidateOptions& options, std::ostream& out = std::cout);

CLI::App* add_validate(CLI::App& app, ValidateOptions& options);

}  // namespace sweepd
