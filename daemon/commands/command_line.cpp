#include "daemon/commands/command_line.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <poll.h>
#include <unistd.h>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"

namespace sweepd {
namespace {

/// `... | head`: that is no mistake.
bool reader_went() {
  pollfd output{STDOUT_FILENO, 0, 0};
  return ::poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

}  // namespace

CommandLine::CommandLine()
    : app_(std::make_unique<CLI::App>(
          "Answer a KUKA controller's RSI telegrams, record them, and identify the robot's "
          "Denavit-Hartenberg parameters from sweeps of single joints\n"
          "`sweepd COMMAND --help` tells the options of a command.",
          "sweepd")) {
  auto& app = *app_;
  app.formatter_fn([](const CLI::App* command, const std::string& called, CLI::AppFormatMode) {
    return help_text(command_text(*command), called);
  });
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("--version", "sweepd " SWEEPD_VERSION, "Print the version and exit");
  // For the build, which installs it. An option without a group is hidden.
  app.add_flag_callback("--bash-completion",
                        [&app] {
                          std::cout << bash_completion(command_text(app));
                          throw CLI::Success();
                        })
      ->group("");
  app.require_subcommand(1);
  app.footer(exit_status(
      {kOk,
       kError,
       kWrongUsage,
       {kAdverse,
        "The result is doubtful (identify, replay), replies were right but late (simulate), or the "
        "robot has changed (compare, history)."},
       kWrongFile}));

  add_commands(app, arguments_, exit_code_);
  refuse_empty_paths(app);
}

CommandLine::~CommandLine() = default;

int CommandLine::execute(int argc, const char* const* argv) {
  const int code = run(argc, argv);
  if (std::cout.flush() || reader_went()) return code;
  std::cerr
      << "sweepd: standard output cannot be written, and is not complete: free some space, or "
         "write it elsewhere\n";
  return code == 0 || code == kAdverse ? kFailed : code;
}

int CommandLine::run(int argc, const char* const* argv) {
  arguments_.assign(argv + std::min(argc, 1), argv + argc);
  try {
    app_->parse(argc, argv);
    return exit_code_;
  } catch (const CLI::Success& printed) {  // help, version
    return app_->exit(printed);
  } catch (const CLI::ParseError& problem) {
    const auto commands = app_->get_subcommands();
    const auto foreign = app_->remaining();  // which no command has taken
    if (!commands.empty() && foreign.empty())
      throw std::invalid_argument(usage_problem(*commands.front(), problem));
    const std::string first = argc > 1 ? argv[1] : "";
    throw std::invalid_argument(no_command(*app_, foreign.empty() ? first : foreign.front()));
  }
}

}  // namespace sweepd
