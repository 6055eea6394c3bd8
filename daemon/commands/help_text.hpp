#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "daemon/commands/command_text.hpp"

namespace sweepd {

/// What --help prints: lines of at most 80 columns, in the form that help2man(1) makes manual pages
/// of. `called` is how the command is called: "sweepd run".
[[nodiscard]] std::string help_text(const CommandText& command, const std::string& called);

struct ExitCode {
  int code;
  std::string_view meaning;
};
/// A section for the footer of a command.
[[nodiscard]] std::string exit_status(const std::vector<ExitCode>& codes);

/// Every key of the settings in the same form, a section for each table.
[[nodiscard]] std::string settings_text();

}  // namespace sweepd
