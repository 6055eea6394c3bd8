#pragma once

#include <string>
#include <vector>

#include "daemon/commands/exit_codes.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

/// A command's option or file argument in words, for its help and for completion.
struct CommandOption {
  std::vector<std::string> names;    ///< "--help", "-h"; an argument without dashes: its own, TRACE
  std::string value;                 ///< what is written after it: FILE, DIR; empty: a flag
  std::vector<std::string> choices;  ///< the only values, if they are a fixed set
  std::string range;                 ///< the only values: "1 to 12"
  std::string fallback;              ///< the default
  bool required = false;
  bool repeated = false;           ///< takes several values
  std::vector<std::string> needs;  ///< options that have to be given with it
  int alternative = 0;  ///< exactly one option of those with the same number, not 0, is given
  std::string help;

  [[nodiscard]] bool positional() const { return names.front().front() != '-'; }
};

/// A command in words, and the program itself, which has commands.
struct CommandText {
  std::string name;
  std::string help;                  ///< what it does: a phrase that begins with a verb
  std::vector<std::string> details;  ///< paragraphs
  std::string footer;                ///< sections that stand below the options, in lines
  std::vector<CommandOption> options;
  std::vector<CommandText> commands;
};

/// What a command line parser knows of its options, but for those that are hidden (without a
/// group). A description's paragraphs are parted by line ends: help first, then the details.
[[nodiscard]] CommandText command_text(const CLI::App& app);

/// What --help prints: lines of at most 80 columns, in the form that help2man(1) makes manual pages
/// of. `called` is how the command is called: "sweepd run".
[[nodiscard]] std::string help_text(const CommandText& command, const std::string& called);

/// A section for the footer of a command.
[[nodiscard]] std::string exit_status(const std::vector<ExitCode>& codes);

/// Every key of the settings in the same form, a section for each table.
[[nodiscard]] std::string settings_text();

/// A script that makes bash complete the program's commands, options, their values where these are
/// a fixed set, and the names of files and folders.
[[nodiscard]] std::string bash_completion(const CommandText& program);

}  // namespace sweepd
