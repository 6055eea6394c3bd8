#pragma once

#include <memory>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class ParseError;
}  // namespace CLI

namespace sweepd {

/// Every command of sweepd with its options: the one table that parses, and that help, manual pages
/// and shell completion are made of.
class CommandLine {
 public:
  CommandLine();
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Runs the command that the arguments of main() ask for, or prints the help that they ask for.
  /// Returns the exit code; throws what the command throws, and std::invalid_argument for wrong
  /// usage, whose text says how it is used. What could not be printed is told on standard error,
  /// and no success.
  [[nodiscard]] int execute(int argc, const char* const* argv);

  [[nodiscard]] const CLI::App& app() const { return *app_; }

 private:
  int run(int argc, const char* const* argv);

  std::unique_ptr<CLI::App> app_;
  std::vector<std::string> arguments_;  // without the program's name
  int exit_code_ = 0;
};

// Its parts.

/// Adds every command with its options, in the order of the help. Whichever is called leaves its
/// exit code in `exit_code`; `arguments` are those of the program, as they stand then. Both must
/// outlive `app`.
void add_commands(CLI::App& app, const std::vector<std::string>& arguments, int& exit_code);

/// What is wrong where `word` is no command; empty: there is none.
[[nodiscard]] std::string no_command(const CLI::App& app, const std::string& word);

/// What is wrong with the options of `command`, in this program's words in place of the parser's.
[[nodiscard]] std::string usage_problem(const CLI::App& command, const CLI::ParseError& problem);

}  // namespace sweepd
