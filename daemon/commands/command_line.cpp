#include "daemon/commands/command_line.hpp"

#include <algorithm>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "daemon/commands/bash_completion.hpp"
#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"

namespace sweepd {

struct CommandLine::Options {
  RunOptions run;
  ReplayOptions replay;
  InspectOptions inspect;
  IdentifyOptions identify;
  SimulateOptions simulate;
  PlanOptions plan;
  ReportOptions report;
  ExportOptions exported;
  CheckOptions check;
};

CommandLine::CommandLine()
    : options_(std::make_unique<Options>()),
      app_(std::make_unique<CLI::App>(
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
       {3, "The result is doubtful (identify, replay), or replies were right but late (simulate)."},
       kWrongFile}));

  const auto on = [this](CLI::App* command, const std::function<int()>& work) {
    command->callback([this, work] { exit_code_ = work(); });
  };
  auto& options = *options_;
  on(add_run(app, options.run), [&options] { return run(options.run); });
  on(add_replay(app, options.replay), [&options] { return replay(options.replay); });
  on(add_inspect(app, options.inspect), [&options] { return inspect(options.inspect); });
  on(add_identify(app, options.identify), [&options] { return identify_points(options.identify); });
  on(add_simulate(app, options.simulate), [&options] { return simulate(options.simulate); });
  on(add_plan(app, options.plan), [&options] { return plan(options.plan); });
  on(add_report(app, options.report), [&options] { return make_report(options.report); });
  on(add_export(app, options.exported), [&options] { return export_csv(options.exported); });
  on(add_check(app, options.check), [&options] {
    if (!options.check.config && options.check.ethernet_configs.empty() &&
        options.check.contexts.empty())
      options.check.config = options.run.config;
    return check(options.check);
  });
}

CommandLine::~CommandLine() = default;

int CommandLine::execute(int argc, const char* const* argv) {
  options_->replay.arguments.assign(argv + std::min(argc, 1), argv + argc);
  options_->identify.arguments = options_->replay.arguments;
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
