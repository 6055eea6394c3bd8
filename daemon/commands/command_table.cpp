#include <memory>

#include <CLI/CLI.hpp>

#include "daemon/commands/check_command.hpp"
#include "daemon/commands/command_line.hpp"
#include "daemon/commands/compare_command.hpp"
#include "daemon/commands/correct_command.hpp"
#include "daemon/commands/export_command.hpp"
#include "daemon/commands/history_command.hpp"
#include "daemon/commands/identify_command.hpp"
#include "daemon/commands/inspect_command.hpp"
#include "daemon/commands/listen_command.hpp"
#include "daemon/commands/note_command.hpp"
#include "daemon/commands/plan_command.hpp"
#include "daemon/commands/plant_commands.hpp"
#include "daemon/commands/replay_command.hpp"
#include "daemon/commands/report_command.hpp"
#include "daemon/commands/run_command.hpp"
#include "daemon/commands/simulate_command.hpp"
#include "daemon/commands/validate_command.hpp"
#include "daemon/commands/watch_command.hpp"

namespace sweepd {
namespace {

/// Adds a command whose options live as long as it does.
template <typename Options, typename Work>
void add(CLI::App& app, CLI::App* (*describe)(CLI::App&, Options&), const Work& work,
         int& exit_code) {
  const auto options = std::make_shared<Options>();
  describe(app, *options)->callback([options, work, &exit_code] { exit_code = work(*options); });
}

}  // namespace

void add_commands(CLI::App& app, const std::vector<std::string>& arguments, int& exit_code) {
  add(app, add_run, run, exit_code);
  add(app, add_watch, watch, exit_code);
  add(
      app, add_replay,
      [&arguments](ReplayOptions& options) {
        options.arguments = arguments;
        return replay(options);
      },
      exit_code);
  add(
      app, add_inspect, [](const InspectOptions& options) { return inspect(options); }, exit_code);
  add(
      app, add_identify,
      [&arguments](IdentifyOptions& options) {
        options.arguments = arguments;
        return identify_points(options);
      },
      exit_code);
  add(
      app, add_listen, [](const ListenOptions& options) { return listen(options); }, exit_code);
  add(
      app, add_simulate, [](const SimulateOptions& options) { return simulate(options); },
      exit_code);
  add(
      app, add_plan, [](const PlanOptions& options) { return plan(options); }, exit_code);
  add(
      app, add_report, [](const ReportOptions& options) { return make_report(options); },
      exit_code);
  add(
      app, add_validate, [](const ValidateOptions& options) { return validate(options); },
      exit_code);
  add(
      app, add_correct, [](const CorrectOptions& options) { return correct(options); }, exit_code);
  add(
      app, add_compare,
      [&arguments](const CompareOptions& options) {
        return options.database ? plant::compare(options, arguments) : compare(options);
      },
      exit_code);
  add(
      app, add_history,
      [&arguments](const HistoryCommandOptions& options) {
        return options.database ? plant::history(options, arguments) : show_history(options);
      },
      exit_code);
  add(
      app, add_note, [](const NoteOptions& options) { return note(options); }, exit_code);
  add(
      app, add_export, [](const ExportOptions& options) { return export_csv(options); }, exit_code);
  add(
      app, add_check,
      [](CheckOptions& options) {
        if (!options.config && options.ethernet_configs.empty() && options.contexts.empty())
          options.config = RunOptions().config;
        return check(options);
      },
      exit_code);
  add(
      app, add_publish,
      [&arguments](const PublishOptions& options) { return plant::publish(options, arguments); },
      exit_code);
  add(
      app, add_collect,
      [&arguments](const CollectOptions& options) { return plant::collect(options, arguments); },
      exit_code);
}

}  // namespace sweepd
