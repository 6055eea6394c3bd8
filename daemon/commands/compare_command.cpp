#include "daemon/commands/compare_command.hpp"

#include <utility>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/results/change.hpp"

namespace sweepd {

int compare(const CompareOptions& options, std::ostream& out) {
  ToldArm first = read_told_arm(options.first);
  ToldArm second = read_told_arm(options.second);
  return compare(options, std::move(first), std::move(second), out);
}

int compare(const CompareOptions& options, ToldArm first, ToldArm second, std::ostream& out) {
  const Change change = change_between(std::move(first), std::move(second), options.level);
  out << (options.json ? change_json(change) : change_text(change));
  return change.test.changed ? kAdverse : 0;
}

CLI::App* add_compare(CLI::App& app, CompareOptions& options) {
  auto* command = app.add_subcommand(
      "compare",
      "Tell whether a robot has changed between two results\n"
      "It compares the numbers that neither conventions nor the place of base, tool and home "
      "change. First it tests all of them together, then each of them, and says how large a "
      "change would have been seen.");
  command->add_option("A", options.first, "The earlier result: a folder, or its result.json")
      ->required()
      ->type_name("");
  command->add_option("B", options.second, "The later result: a folder, or its result.json")
      ->required()
      ->type_name("");
  add_number(*command, "--level", options.level, number_between(1e-6, 0.5),
             "Call this share of unchanged pairs changed, and no more")
      ->type_name("SHARE");
  command
      ->add_option("--database", options.database,
                   "Take A and B from this PostgreSQL, as `sweepd collect` has filled it: each is "
                   "SITE/CELL/ROBOT, its newest result, or SITE/CELL/ROBOT/START")
      ->type_name("CONNECTION");
  command->add_flag("--json", options.json, "Print JSON in place of the text");
  command->footer(exit_status({{0, "No change is seen."},
                               {kAdverse, "The robot has changed."},
                               {kFailed,
                                "The two cannot be compared. A line on standard error says why, "
                                "and what to do."},
                               kWrongUsage}));
  return command;
}

}  // namespace sweepd
