#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "daemon/history/campaign_folders.hpp"
#include "daemon/results/change_test.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct HistoryCommandOptions {
  std::vector<std::filesystem::path> of;  ///< folders, or names of robots in settings or database
  std::filesystem::path config;
  std::optional<std::string> since;
  std::optional<std::string> same_state;  ///< FROM..TO
  std::optional<std::filesystem::path> reference;
  std::string kind;  ///< arm, model; empty: arm where there is any
  double level = kUsualLevel;
  std::optional<std::filesystem::path> csv, html, index;
  std::optional<std::string> database;  ///< how to reach it; nothing: folders
  bool rebuild = false;
  bool force = false;
};

/// Tells how the numbers of a robot went over its campaigns. Returns the exit code: 3 where a
/// change can be dated. Throws std::invalid_argument, ConfigError and std::runtime_error.
[[nodiscard]] int show_history(const HistoryCommandOptions& options, std::ostream& out = std::cout);

/// The same of campaigns that were found elsewhere than in folders.
[[nodiscard]] int show_history(const HistoryCommandOptions& options, FoundCampaigns found,
                               std::ostream& out = std::cout);

CLI::App* add_history(CLI::App& app, HistoryCommandOptions& options);

}  // namespace sweepd
