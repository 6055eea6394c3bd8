#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "daemon/settings/settings.hpp"
#include "rsi/endpoint.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct RunOptions {
  std::filesystem::path config = "/etc/sweepd/sweepd.toml";
  std::optional<std::filesystem::path> output;  ///< in place of every robot's own
  std::optional<rsi::Endpoint> listen;          ///< in place of the one robot's own
};

/// The daemon, in the foreground, until SIGINT or SIGTERM. Then the last result and the recording
/// are completed, and the sockets close last. A robot that cannot be served is tried again while
/// others are. Returns the exit code; throws ConfigError before anything is served, and
/// std::runtime_error where nothing can be.
[[nodiscard]] int run(const RunOptions& options);

/// The same for settings that `read` gives, at the start and on SIGHUP, where any thread calls it.
[[nodiscard]] int serve_robots(const std::function<Settings()>& read);

CLI::App* add_run(CLI::App& app, RunOptions& options);

}  // namespace sweepd
