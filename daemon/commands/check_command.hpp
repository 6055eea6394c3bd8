#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct CheckOptions {
  std::optional<std::filesystem::path> config = {};
  std::vector<std::filesystem::path> ethernet_configs = {};  ///< to be looked at by themselves
  /// RSI contexts: of the settings' one robot, or else to be looked at by themselves.
  std::vector<std::filesystem::path> contexts = {};
  bool files_only = false;  ///< whether this machine can do what the settings say is left alone
};

/// Looks at settings, robot descriptions, plans and the controller's files, each by itself and
/// against each other, and at the machine: port, addresses, real time, disk. Prints what was found,
/// a finding a line, and the reply that would be sent. Binds each port for a moment.
///
/// Returns the exit code: 0; 78 if a file is wrong; 1 if the files are right, but this machine
/// cannot do what they say. Warnings are neither.
[[nodiscard]] int check(const CheckOptions& options, std::ostream& out = std::cout);

CLI::App* add_check(CLI::App& app, CheckOptions& options);

}  // namespace sweepd
