#include "daemon/commands/command_line.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "daemon/commands/bash_completion.hpp"
#include "daemon/commands/command_table.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"

namespace sweepd {

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
       {3,
        "The result is doubtful (identify, replay), replies were right but late (simulate), or the "
        "robot has changed (compare, history)."},
       kWrongFile}));

  add_commands(app, arguments_, exit_code_);
}

CommandLine::~CommandLine() = default;

int CommandLine::execute(int argc, const char* const* argv) {
  arguments_.assign(argv + std::min(argc, 1), argv + argc);
  try {
    app_->parse(argc, argv);
    return exit_code_;
  } catch (const CLI::Success& printed) {  // help, version
    return app_->exit(printed);
  } catch (const CLI::ParseError& problem) {
    const auto commands = app_->get_subcommands();
    const bool unknown = commands.empty() && argc > 1 && argv[1][0] != '-';
    throw std::invalid_argument(
        (unknown ? std::string(argv[1]) + " is no command" : std::string(problem.what())) +
        ": `sweepd " + (commands.empty() ? "" : commands.front()->get_name() + " ") +
        "--help` tells how it is used");
  }
}

}  // namespace sweepd
