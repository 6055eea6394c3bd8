#include "daemon/command_line.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/axes_file.hpp"
#include "daemon/check_command.hpp"
#include "daemon/export_command.hpp"
#include "daemon/identify_command.hpp"
#include "daemon/inspect_command.hpp"
#include "daemon/point_columns.hpp"
#include "daemon/replay_command.hpp"
#include "daemon/run_command.hpp"
#include "daemon/simulate_command.hpp"
#include "identify/sample.hpp"

namespace sweepd {

namespace {

/// The value of an option that is an endpoint or an address.
template <typename Value, typename Parse>
CLI::callback_t parsed(std::optional<Value>& into, const Parse& parse) {
  return [&into, parse](const CLI::results_t& texts) {
    into = parse(texts.front());
    return into.has_value();
  };
}

void add_filter(CLI::App& command, rsi::ConversationFilter& filter) {
  command.add_option("--port", filter.port,
                     "The conversation whose RSI server has this port (default: the busiest)");
  command
      .add_option("--controller", parsed(filter.controller, rsi::parse_address),
                  "The conversation of the controller with this address (default: the busiest)")
      ->type_name("ADDRESS");
}

void add_traces(CLI::App& command, std::vector<std::filesystem::path>& traces) {
  command.add_option("TRACE", traces, "Captures of one stream: all parts of a trace, in any order")
      ->required()
      ->type_name("");
}

CLI::App* add_run(CLI::App& app, RunOptions& options) {
  auto* command = app.add_subcommand("run", "The daemon, in the foreground: serve the controllers");
  command->add_option("--config", options.config, "Settings")
      ->capture_default_str()
      ->type_name("FILE");
  command
      ->add_option("--output", options.output,
                   "Folder for recordings and results (default: settings)")
      ->type_name("DIR");
  command
      ->add_option("--listen", parsed(options.listen, rsi::parse_endpoint),
                   "Address and port of the one robot (default: settings)")
      ->type_name("ADDRESS:PORT");
  return command;
}

CLI::App* add_replay(CLI::App& app, ReplayOptions& options) {
  auto* command =
      app.add_subcommand("replay", "The same on captures (pcap, pcapng), as fast as it goes");
  add_traces(*command, options.traces);
  command->add_option("--config", options.config, "Settings")->type_name("FILE");
  command->add_option("--robot", options.robot, "Robot description (default: settings)")
      ->type_name("FILE");
  command
      ->add_option("--plan", options.plan,
                   "Sweep plan: the order of joints where telegrams carry no angles (default: "
                   "settings)")
      ->type_name("FILE");
  command->add_option("--output", options.output, "Folder for the result files (default: none)")
      ->type_name("DIR");
  add_filter(*command, options.filter);
  command->add_flag("--quiet", options.quiet, "No progress, no report");
  return command;
}

CLI::App* add_inspect(CLI::App& app, InspectOptions& options) {
  auto* command = app.add_subcommand(
      "inspect", "How the link did: loss, jitter, reply latency, late replies, with a verdict");
  add_traces(*command, options.traces);
  add_filter(*command, options.filter);
  command
      ->add_option("--json", options.json,
                   "Write the report as JSON too; - is standard output, in place of the text")
      ->type_name("FILE");
  command->add_flag("--quiet", options.quiet, "No progress, no text");
  command->footer(
      "The verdict is good, marginal or bad, each reason with what to do about it.\n"
      "Exit codes: 0 good or marginal, 1 bad, or no RSI in the captures.");
  return command;
}

CLI::App* add_identify(CLI::App& app, IdentifyOptions& options) {
  auto* command = app.add_subcommand("identify", "From points that another device measured (CSV)");
  command->add_option("FILE", options.points, "Measured points")->type_name("");
  command
      ->add_option("--axes", options.axes,
                   "Joint axes as lines, in place of points: straight to DH")
      ->type_name("FILE");
  command
      ->add_option(
          "--columns", options.columns,
          "Names of the columns, with commas between, where no header tells them or a wrong "
          "one; - or _ for one to skip (a list that begins with -: --columns=-,...)")
      ->type_name("NAMES");
  command->add_flag("--per-joint", options.per_joint, "One file a joint: joint 1 first");
  command
      ->add_option("--robot", options.robot,
                   "Robot description, to compare with (default: none, nothing is compared)")
      ->type_name("FILE");
  command
      ->add_option("--plan", options.plan,
                   "Sweep plan: home, directions and order of joints where no angles tell them")
      ->type_name("FILE");
  command
      ->add_option(
          "--joints", options.joints,
          "Of the arm (default: of the description or plan, or as many as the points name, "
          "or 6)")
      ->check(CLI::Range(std::size_t{1}, identify::kMostJoints));
  command
      ->add_option_function<std::string>(
          "--frame",
          [&options](const std::string& frame) { options.device_frame = frame == "device"; },
          "Whose frame the points are in: where the robot stands in a device's is found out "
          "(default: device)")
      ->type_name("device|robot")
      ->check(CLI::IsMember({"device", "robot"}));
  command->add_option("--output", options.output, "Folder for the result files (default: none)")
      ->type_name("DIR");
  command->add_flag("--quiet", options.quiet, "No progress, no report");
  command->footer(
      R"(Points: text with commas, semicolons, tabs or blanks between columns; lines that begin
with # are passed over. The header names columns and units, in any order:
  )" + std::string(kPointColumns) +
      R"(
A column target (number or name) tells target points apart. samples.csv and sweeps.csv
of sweepd are understood as they are.

Either a stream with t_s, in which sweeps are found as in a live one; or a column joint:
each run of lines with the same joint is a sweep; or one file a joint with --per-joint,
which with t_s may hold rests and several strokes.

Axes: a header as above, and a line a joint with a point of its axis and the direction:
  )" + std::string(kAxisColumns));
  return command;
}

CLI::App* add_simulate(CLI::App& app, SimulateOptions& options) {
  auto* command = app.add_subcommand(
      "simulate", "Stands in for a controller whose robot runs a sweep plan; checks every reply");
  command->add_option("--robot", options.robot, "Robot description")->required()->type_name("FILE");
  command->add_option("--plan", options.plan, "Sweep plan")->required()->type_name("FILE");
  auto* target = command->add_option_group("Target", "Where the telegrams go: one of");
  target
      ->add_option("--to", parsed(options.to, rsi::parse_endpoint),
                   "An RSI server, in real time; over TCP if the Ethernet file says so")
      ->type_name("ADDRESS:PORT");
  target->add_option("--write", options.write, "A capture, as fast as it goes")
      ->type_name("TRACE.pcap");
  target->require_option(1);
  command
      ->add_option("--ethernet-config", options.ethernet_config,
                   "The controller's Ethernet file (default: the shipped one)")
      ->type_name("FILE");
  command->add_option("--seed", options.seed, "Of wobble and faults")->capture_default_str();
  command->add_option("--wobble-deg", options.wobble_deg, "Servo wobble of every joint, sigma")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--precision", options.precision, "Decimals, as at the ETHERNET object")
      ->check(CLI::Range(0, 15))
      ->capture_default_str();
  command->add_option("--cycle-ms", options.cycle_ms, "4 on IPO_FAST, 12 on IPO")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--timeout-cycles", options.timeout_cycles,
                   "Unanswered cycles in a row until the controller stops")
      ->capture_default_str();
  command->add_option("--first-ipoc", options.first_ipoc, "IPOC of the first telegram")
      ->capture_default_str();
  for (const auto& [name, value, help] :
       {std::tuple{"--lose-percent", &options.lose_percent, "Telegrams lost on purpose"},
        std::tuple{"--duplicate-percent", &options.duplicate_percent, "Telegrams sent twice"},
        std::tuple{"--swap-percent", &options.swap_percent,
                   "Telegrams exchanged with the next one"}})
    command->add_option(name, *value, help)->check(CLI::Range(0.0, 100.0))->capture_default_str();
  command
      ->add_option("--tool-mm", options.tool_mm,
                   "Target point in the frame after the last row (default: the description's)")
      ->type_name("X,Y,Z")
      ->delimiter(',');
  command->add_flag("--quiet", options.quiet, "No progress, no report");
  return command;
}

CLI::App* add_export(CLI::App& app, ExportOptions& options) {
  auto* command =
      app.add_subcommand("export", "Every signal of a capture as CSV, a row a telegram");
  add_traces(*command, options.traces);
  command->add_option("--csv", options.csv, "The file to write; - is standard output")
      ->required()
      ->type_name("FILE");
  add_filter(*command, options.filter);
  return command;
}

CLI::App* add_check(CLI::App& app, CheckOptions& options) {
  auto* command = app.add_subcommand(
      "check", "Settings, robot, plan and the controller's Ethernet file against each other");
  command
      ->add_option(
          "--config", options.config,
          "Settings, and all files that they name (default, unless Ethernet files are given: "
          "those of `run`)")
      ->type_name("FILE");
  command->add_option("--ethernet-config", options.ethernet_configs, "Ethernet files by themselves")
      ->type_name("FILE");
  return command;
}

}  // namespace

struct CommandLine::Options {
  RunOptions run;
  ReplayOptions replay;
  InspectOptions inspect;
  IdentifyOptions identify;
  SimulateOptions simulate;
  ExportOptions exported;
  CheckOptions check;
};

CommandLine::CommandLine()
    : options_(std::make_unique<Options>()),
      app_(std::make_unique<CLI::App>(
          "Answers a KUKA controller's RSI telegrams, records them, and identifies the robot's "
          "Denavit-Hartenberg parameters from single-joint sweeps.",
          "sweepd")) {
  auto& app = *app_;
  app.set_version_flag("--version", "sweepd " SWEEPD_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 78 wrong configuration.\n"
      "`sweepd COMMAND --help` tells the options of a command.");

  const auto on = [this](CLI::App* command, const std::function<int()>& work) {
    command->callback([this, work] { exit_code_ = work(); });
  };
  auto& options = *options_;
  on(add_run(app, options.run), [&options] { return run(options.run); });
  on(add_replay(app, options.replay), [&options] { return replay(options.replay); });
  on(add_inspect(app, options.inspect), [&options] { return inspect(options.inspect); });
  on(add_identify(app, options.identify), [&options] { return identify_points(options.identify); });
  on(add_simulate(app, options.simulate), [&options] { return simulate(options.simulate); });
  on(add_export(app, options.exported), [&options] { return export_csv(options.exported); });
  on(add_check(app, options.check), [&options] {
    if (!options.check.config && options.check.ethernet_configs.empty())
      options.check.config = options.run.config;
    return check(options.check);
  });
}

CommandLine::~CommandLine() = default;

int CommandLine::execute(int argc, const char* const* argv) {
  try {
    app_->parse(argc, argv);
    return exit_code_;
  } catch (const CLI::CallForHelp& help) {
    return app_->exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app_->exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app_->exit(version);
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
