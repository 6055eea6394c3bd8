#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "rsi/capture/conversation.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct ReplayOptions {
  std::vector<std::filesystem::path> traces;  ///< of one stream, in any order
  std::optional<std::filesystem::path> config;
  std::optional<std::filesystem::path> robot;  ///< a description, in place of the settings' own
  std::optional<std::filesystem::path> plan;   ///< in place of the settings' own
  std::optional<std::filesystem::path> output;
  rsi::ConversationFilter filter;
  bool quiet = false;                       ///< no progress, no report
  bool force = false;                       ///< over any files but those that are read
  std::vector<std::string> arguments = {};  ///< as it was called, for run.json
};

/// The live path on captures, as fast as it goes: the same samples give the same result files. The
/// report goes to `report`, what is wrong with the captures to `errors`, a sentence each. Returns
/// the exit code: 3 if the result is doubtful, 1 if not one axis was identified for want of data,
/// or samples.csv is not whole. Throws ConfigError, rsi::CaptureError, std::runtime_error, and as
/// Outputs where results may not be written.
[[nodiscard]] int replay(const ReplayOptions& options, std::ostream& report = std::cout,
                         std::ostream& errors = std::cerr);

CLI::App* add_replay(CLI::App& app, ReplayOptions& options);

}  // namespace sweepd
