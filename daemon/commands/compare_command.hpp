#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "daemon/results/change_test.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct ToldArm;

struct CompareOptions {
  std::filesystem::path first;  ///< folders or result.json files
  std::filesystem::path second;
  double level = kUsualLevel;
  bool json = false;
  std::optional<std::string> database = {};  ///< PostgreSQL that has both, in place of files
};

/// Whether the arm of the second result is another than that of the first: says so on `out`.
/// Returns the exit code: 0 where no change is seen, 3 where there is one. Throws
/// std::runtime_error where the two cannot be compared.
[[nodiscard]] int compare(const CompareOptions& options, std::ostream& out = std::cout);

/// The same of arms that were read.
[[nodiscard]] int compare(const CompareOptions& options, ToldArm first, ToldArm second,
                          std::ostream& out = std::cout);

CLI::App* add_compare(CLI::App& app, CompareOptions& options);

}  // namespace sweepd
