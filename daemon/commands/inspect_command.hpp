#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <vector>

#include "rsi/capture/conversation.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct InspectOptions {
  std::vector<std::filesystem::path> traces;  ///< of one stream, in any order
  rsi::ConversationFilter filter = {};
  std::optional<std::filesystem::path> json =
      {};              ///< "-": to standard output, in place of the text
  bool quiet = false;  ///< no progress, no text
  bool force = false;  ///< over any file but the captures
};

/// How the link between a controller and its RSI server did, from captures: the report goes to
/// `out`, what is wrong with the captures to `errors`, a sentence each. Returns the exit code: 1 if
/// there are no telegrams or the verdict is bad. Throws rsi::CaptureError, std::runtime_error,
/// and as Outputs where the file may not be written.
[[nodiscard]] int inspect(const InspectOptions& options, std::ostream& out = std::cout,
                          std::ostream& errors = std::cerr);

CLI::App* add_inspect(CLI::App& app, InspectOptions& options);

}  // namespace sweepd
