#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <vector>

namespace sweepd {

struct CheckOptions {
  std::optional<std::filesystem::path> config;
  std::vector<std::filesystem::path> ethernet_configs;  ///< to be looked at by themselves
};

/// Looks at settings, robot descriptions, plans and the controller's Ethernet files, each by itself
/// and against each other, and prints what was found, a finding a line, and the reply that would be
/// sent. Returns the exit code: 0, or 78 if anything is wrong; warnings are not.
[[nodiscard]] int check(const CheckOptions& options, std::ostream& out = std::cout);

}  // namespace sweepd
