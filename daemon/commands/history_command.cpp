#include "daemon/commands/history_command.hpp"

#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/commands/run_command.hpp"
#include "daemon/history/history.hpp"
#include "daemon/history/history_words.hpp"
#include "daemon/settings/settings.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCsvBegin = "time,campaign,status,state,t_squared";

/// Where a robot of the settings leaves its results; a folder is itself.
fs::path folder_of(const fs::path& given, const fs::path& config) {
  std::error_code error;
  if (fs::exists(given, error)) return given;
  if (!fs::exists(config, error))
    throw std::runtime_error(
        given.string() + " is no folder, and there are no settings " + config.string() +
        " that could tell a robot of this name: name a folder of results, or the "
        "settings with --config");
  const Settings settings = load_settings(config);
  for (const RobotSettings& robot : settings.robots)
    if (robot.name == given) return robot.output / robot.name;
  throw std::runtime_error(given.string() + " is no folder, and no robot in " + config.string() +
                           ": name a folder of results, or a robot of these settings");
}

std::pair<std::chrono::nanoseconds, std::chrono::nanoseconds> period(const std::string& text) {
  const auto between = text.find("..");
  if (between == text.npos)
    throw std::invalid_argument("--same-state: write FROM..TO, as 2026-01-01..2026-06-30");
  const auto from = date_option("--same-state", text.substr(0, between));
  const auto to = date_option("--same-state", text.substr(between + 2));
  if (to < from)
    throw std::invalid_argument("--same-state: " + text +
                                " ends before it begins: write the earlier date first");
  return {from, to};
}

}  // namespace

int show_history(const HistoryCommandOptions& options, std::ostream& out) {
  std::vector<fs::path> folders;
  for (const fs::path& given : options.of)
    folders.push_back(
        folder_of(given, options.config.empty() ? RunOptions().config : options.config));
  return show_history(options, campaigns_in(folders, {options.index, options.rebuild}), out);
}

int show_history(const HistoryCommandOptions& options, FoundCampaigns found, std::ostream& out) {
  HistoryOptions how;
  how.level = options.level;
  how.reference = options.reference;
  if (options.since) how.since = date_option("--since", *options.since);
  if (options.same_state) how.same_state = period(*options.same_state);
  if (!options.kind.empty()) how.describes = options.kind == "arm" ? "arm" : "controller_model";
  if (options.csv && options.html) check_apart("--csv and --html", *options.csv, *options.html);
  const Outputs outputs(files_of(found), options.force);
  if (options.csv) outputs.check(*options.csv, kCsvBegin);
  if (options.html) outputs.check(*options.html, kHistoryBegin);
  const History history = history_of(std::move(found), how);
  if (options.csv) write_output(*options.csv, history_csv(history));
  if (options.html) write_output(*options.html, history_page(history));
  out << history_text(history);
  return history.changes.empty() ? 0 : kAdverse;
}

CLI::App* add_history(CLI::App& app, HistoryCommandOptions& options) {
  auto* command = app.add_subcommand(
      "history",
      "Tell how a robot's numbers went over its campaigns, what has changed, and when\n"
      "It compares all campaigns with a reference, tells jumps from slow drifts, dates and names "
      "them, and shows friction, the link and notes beside them. How well campaigns repeat is "
      "taken from those that `sweepd note DIR --same-state NAME` marks.");
  command
      ->add_option("DIR", options.of,
                   "Folders of results, or folders that hold such. Or the name of a robot in the "
                   "settings")
      ->required()
      ->type_name("");
  command->add_option("--config", options.config, "Find the robot in these settings")
      ->type_name("FILE")
      ->default_str(RunOptions().config.string());
  command
      ->add_option("--since", options.since,
                   "Look for changes only among campaigns since this date, in UTC")
      ->type_name("DATE");
  command->add_option("--reference", options.reference, "Compare with this campaign and its state")
      ->type_name("DIR")
      ->default_str("the first that is marked, else the first that is complete");
  command
      ->add_option("--same-state", options.same_state,
                   "Take all campaigns between these dates for one state of the robot, as if they "
                   "were marked")
      ->type_name("FROM..TO");
  command
      ->add_option("--of", options.kind,
                   "Take results of the arm, or of the controller's model. The two are never mixed")
      ->check(CLI::IsMember({"arm", "model"}))
      ->type_name("arm|model")
      ->default_str("arm where there is any");
  add_number(*command, "--level", options.level, number_between(1e-6, 0.5),
             "Call this share of unchanged campaigns, and of unchanged histories, changed")
      ->type_name("SHARE");
  command->add_option("--csv", options.csv, "Write a line for each campaign to this file")
      ->type_name("FILE");
  command->add_option("--html", options.html, "Write a page with pictures to this file")
      ->type_name("FILE");
  auto* index =
      command->add_option("--index", options.index, "Keep the index of the campaigns in this file")
          ->type_name("FILE")
          ->default_str("history.sqlite in DIR where there are 100 and more");
  auto* rebuild =
      command->add_flag("--rebuild", options.rebuild, "Make the index anew from the folders");
  command
      ->add_option("--database", options.database,
                   "Take the campaigns from this PostgreSQL, as `sweepd collect` has filled it: "
                   "each DIR is then SITE/CELL/ROBOT")
      ->type_name("CONNECTION")
      ->excludes(index)
      ->excludes(rebuild);
  add_force(*command, options.force);
  command->footer(exit_status({{0, "No change is seen that can be dated."},
                               {kAdverse, "A change is seen."},
                               kError,
                               kWrongUsage,
                               kWrongFile}));
  return command;
}

}  // namespace sweepd
