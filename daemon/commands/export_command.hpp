#pragma once

#include <filesystem>
#include <iostream>
#include <vector>

#include "rsi/capture/conversation.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct ExportOptions {
  std::vector<std::filesystem::path> traces;
  std::filesystem::path csv;  ///< "-": standard output
  rsi::ConversationFilter filter;
  bool force = false;  ///< over any file but the captures
};

/// What RSIMonitor saved: a row a telegram in the order of reception, with the time in seconds
/// since the first, the IPOC, the position, then every other signal that occurs in the captures, as
/// it was printed by the controller. A telegram without a signal leaves its column empty. Returns
/// the exit code: 1 if there are no telegrams. Throws rsi::CaptureError, std::runtime_error, and as
/// Outputs where the file may not be written.
[[nodiscard]] int export_csv(const ExportOptions& options, std::ostream& out = std::cout,
                             std::ostream& errors = std::cerr);

CLI::App* add_export(CLI::App& app, ExportOptions& options);

}  // namespace sweepd
