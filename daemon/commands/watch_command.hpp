#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct WatchOptions {
  std::string interface = "any";
  bool promiscuous = false;
  std::optional<std::uint16_t> port;            ///< of the RSI server; absent: where RSI goes to
  std::optional<std::filesystem::path> config;  ///< its robots, by `listen`
  std::optional<std::filesystem::path> robot;   ///< a description
  std::optional<std::filesystem::path> plan;
  std::optional<std::filesystem::path> output;  ///< in place of every robot's own
};

/// As `run`, where another program answers: records, identifies and tells of the link what passes
/// an interface, and sends nothing, until SIGINT or SIGTERM. Returns the exit code; throws
/// ConfigError, and std::runtime_error where the interface cannot be watched.
[[nodiscard]] int watch(const WatchOptions& options);

CLI::App* add_watch(CLI::App& app, WatchOptions& options);

}  // namespace sweepd
