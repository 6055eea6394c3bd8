#pragma once

#include <cstddef>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "daemon/settings/settings.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct ListenOptions {
  std::optional<TextPort> port;                 ///< or that of `config`
  std::optional<std::filesystem::path> config;  ///< port and columns of its only device
  std::string columns;                          ///< empty: those of `config`, or none
  bool print = false;                           ///< each line, and what the columns make of it
  std::size_t lines = 0;                        ///< end after so many; 0: do not
  double seconds = 0;                           ///< end after this time; 0: do not
};

/// Adds the command, whose options go into `options`.
CLI::App* add_listen(CLI::App& app, ListenOptions& options);

/// Shows what a device sends until it is told to end: SIGINT, SIGTERM, --lines or --seconds.
/// Returns 1 where nothing came that the columns fit, and `errors` says so. Throws
/// std::invalid_argument, ConfigError, and std::runtime_error where it cannot listen.
[[nodiscard]] int listen(const ListenOptions& options, std::ostream& out = std::cout,
                         std::ostream& errors = std::cerr);

}  // namespace sweepd
