#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "daemon/axes_file.hpp"
#include "daemon/check_command.hpp"
#include "daemon/config_error.hpp"
#include "daemon/export_command.hpp"
#include "daemon/identify_command.hpp"
#include "daemon/inspect_command.hpp"
#include "daemon/point_columns.hpp"
#include "daemon/replay_command.hpp"
#include "daemon/run_command.hpp"
#include "daemon/simulate_command.hpp"
#include "identify/sample.hpp"
#include "rsi/ethernet_config.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kConfigError = 78;  // EX_CONFIG of sysexits.h

int say(const std::exception& problem, int exit_code) {
  std::cerr << "sweepd: " << problem.what() << '\n';
  return exit_code;
}

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

void add_identify(CLI::App& command, sweepd::IdentifyOptions& options) {
  command.add_option("FILE", options.points, "Measured points")->type_name("");
  command
      .add_option("--axes", options.axes, "Joint axes as lines, in place of points: straight to DH")
      ->type_name("FILE");
  command
      .add_option(
          "--columns", options.columns,
          "Names of the columns, with commas between, where no header tells them or a wrong "
          "one; - or _ for one to skip (a list that begins with -: --columns=-,...)")
      ->type_name("NAMES");
  command.add_flag("--per-joint", options.per_joint, "One file a joint: joint 1 first");
  command
      .add_option("--robot", options.robot,
                  "Robot description, to compare with (default: none, nothing is compared)")
      ->type_name("FILE");
  command
      .add_option("--plan", options.plan,
                  "Sweep plan: home, directions and order of joints where no angles tell them")
      ->type_name("FILE");
  command
      .add_option("--joints", options.joints,
                  "Of the arm (default: of the description or plan, or as many as the points name, "
                  "or 6)")
      ->check(CLI::Range(std::size_t{1}, identify::kMostJoints));
  command
      .add_option_function<std::string>(
          "--frame",
          [&options](const std::string& frame) { options.device_frame = frame == "device"; },
          "Whose frame the points are in: where the robot stands in a device's is found out "
          "(default: device)")
      ->type_name("device|robot")
      ->check(CLI::IsMember({"device", "robot"}));
  command.add_option("--output", options.output, "Folder for the result files (default: none)")
      ->type_name("DIR");
  command.add_flag("--quiet", options.quiet, "No progress, no report");
  command.footer(
      R"(Points: text with commas, semicolons, tabs or blanks between columns; lines that begin
with # are passed over. The header names columns and units, in any order:
  )" + std::string(sweepd::kPointColumns) +
      R"(
A column target (number or name) tells target points apart. samples.csv and sweeps.csv
of sweepd are understood as they are.

Either a stream with t_s, in which sweeps are found as in a live one; or a column joint:
each run of lines with the same joint is a sweep; or one file a joint with --per-joint,
which with t_s may hold rests and several strokes.

Axes: a header as above, and a line a joint with a point of its axis and the direction:
  )" + std::string(sweepd::kAxisColumns));
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("sweepd"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");

  CLI::App app(
      "Answers a KUKA controller's RSI telegrams, records them, and identifies the robot's "
      "Denavit-Hartenberg parameters from single-joint sweeps.",
      "sweepd");
  app.set_version_flag("--version", "sweepd " SWEEPD_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 78 wrong configuration.\n"
      "`sweepd COMMAND --help` tells the options of a command.");
  int exit_code = 0;

  sweepd::RunOptions run;
  auto* command = app.add_subcommand("run", "The daemon, in the foreground: serve the controllers");
  command->add_option("--config", run.config, "Settings")->capture_default_str()->type_name("FILE");
  command
      ->add_option("--output", run.output, "Folder for recordings and results (default: settings)")
      ->type_name("DIR");
  command
      ->add_option("--listen", parsed(run.listen, rsi::parse_endpoint),
                   "Address and port of the one robot (default: settings)")
      ->type_name("ADDRESS:PORT");
  command->callback([&] { exit_code = sweepd::run(run); });

  sweepd::ReplayOptions replay;
  command = app.add_subcommand("replay", "The same on captures (pcap, pcapng), as fast as it goes");
  command
      ->add_option("TRACE", replay.traces,
                   "Captures of one stream: all parts of a trace, in any order")
      ->required()
      ->type_name("");
  command->add_option("--config", replay.config, "Settings")->type_name("FILE");
  command->add_option("--robot", replay.robot, "Robot description (default: settings)")
      ->type_name("FILE");
  command
      ->add_option("--plan", replay.plan,
                   "Sweep plan: the order of joints where telegrams carry no angles (default: "
                   "settings)")
      ->type_name("FILE");
  command->add_option("--output", replay.output, "Folder for the result files (default: none)")
      ->type_name("DIR");
  add_filter(*command, replay.filter);
  command->add_flag("--quiet", replay.quiet, "No progress, no report");
  command->callback([&] { exit_code = sweepd::replay(replay); });

  sweepd::InspectOptions inspect;
  command = app.add_subcommand(
      "inspect", "How the link did: loss, jitter, reply latency, late replies, with a verdict");
  command
      ->add_option("TRACE", inspect.traces,
                   "Captures of one stream: all parts of a trace, in any order")
      ->required()
      ->type_name("");
  add_filter(*command, inspect.filter);
  command
      ->add_option("--json", inspect.json,
                   "Write the report as JSON too; - is standard output, in place of the text")
      ->type_name("FILE");
  command->add_flag("--quiet", inspect.quiet, "No progress, no text");
  command->footer(
      "The verdict is good, marginal or bad, each reason with what to do about it.\n"
      "Exit codes: 0 good or marginal, 1 bad, or no RSI in the captures.");
  command->callback([&] { exit_code = sweepd::inspect(inspect); });

  sweepd::IdentifyOptions identify;
  command = app.add_subcommand("identify", "From points that another device measured (CSV)");
  add_identify(*command, identify);
  command->callback([&] { exit_code = sweepd::identify_points(identify); });

  sweepd::SimulateOptions simulate;
  command = app.add_subcommand(
      "simulate", "Stands in for a controller whose robot runs a sweep plan; checks every reply");
  command->add_option("--robot", simulate.robot, "Robot description")
      ->required()
      ->type_name("FILE");
  command->add_option("--plan", simulate.plan, "Sweep plan")->required()->type_name("FILE");
  auto* target = command->add_option_group("Target", "Where the telegrams go: one of");
  target
      ->add_option("--to", parsed(simulate.to, rsi::parse_endpoint),
                   "An RSI server, in real time; over TCP if the Ethernet file says so")
      ->type_name("ADDRESS:PORT");
  target->add_option("--write", simulate.write, "A capture, as fast as it goes")
      ->type_name("TRACE.pcap");
  target->require_option(1);
  command
      ->add_option("--ethernet-config", simulate.ethernet_config,
                   "The controller's Ethernet file (default: the shipped one)")
      ->type_name("FILE");
  command->add_option("--seed", simulate.seed, "Of wobble and faults")->capture_default_str();
  command->add_option("--wobble-deg", simulate.wobble_deg, "Servo wobble of every joint, sigma")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--precision", simulate.precision, "Decimals, as at the ETHERNET object")
      ->check(CLI::Range(0, 15))
      ->capture_default_str();
  command->add_option("--cycle-ms", simulate.cycle_ms, "4 on IPO_FAST, 12 on IPO")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--timeout-cycles", simulate.timeout_cycles,
                   "Unanswered cycles in a row until the controller stops")
      ->capture_default_str();
  command->add_option("--first-ipoc", simulate.first_ipoc, "IPOC of the first telegram")
      ->capture_default_str();
  for (const auto& [name, value, help] :
       {std::tuple{"--lose-percent", &simulate.lose_percent, "Telegrams lost on purpose"},
        std::tuple{"--duplicate-percent", &simulate.duplicate_percent, "Telegrams sent twice"},
        std::tuple{"--swap-percent", &simulate.swap_percent,
                   "Telegrams exchanged with the next one"}})
    command->add_option(name, *value, help)->check(CLI::Range(0.0, 100.0))->capture_default_str();
  command
      ->add_option("--tool-mm", simulate.tool_mm,
                   "Target point in the frame after the last row (default: the description's)")
      ->type_name("X,Y,Z")
      ->delimiter(',');
  command->add_flag("--quiet", simulate.quiet, "No progress, no report");
  command->callback([&] { exit_code = sweepd::simulate(simulate); });

  sweepd::ExportOptions exported;
  command = app.add_subcommand("export", "Every signal of a capture as CSV, a row a telegram");
  command
      ->add_option("TRACE", exported.traces,
                   "Captures of one stream: all parts of a trace, in any order")
      ->required()
      ->type_name("");
  command->add_option("--csv", exported.csv, "The file to write; - is standard output")
      ->required()
      ->type_name("FILE");
  add_filter(*command, exported.filter);
  command->callback([&] { exit_code = sweepd::export_csv(exported); });

  sweepd::CheckOptions check;
  command = app.add_subcommand(
      "check", "Settings, robot, plan and the controller's Ethernet file against each other");
  command
      ->add_option(
          "--config", check.config,
          "Settings, and all files that they name (default, unless Ethernet files are given: "
          "those of `run`)")
      ->type_name("FILE");
  command->add_option("--ethernet-config", check.ethernet_configs, "Ethernet files by themselves")
      ->type_name("FILE");
  command->callback([&] {
    if (!check.config && check.ethernet_configs.empty()) check.config = run.config;
    exit_code = sweepd::check(check);
  });
  try {
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CLI::ParseError& problem) {
    const auto commands = app.get_subcommands();
    const bool unknown = commands.empty() && argc > 1 && argv[1][0] != '-';
    std::cerr << "sweepd: "
              << (unknown ? std::string(argv[1]) + " is no command" : std::string(problem.what()))
              << ": `sweepd " << (commands.empty() ? "" : commands.front()->get_name() + " ")
              << "--help` tells how it is used\n";
    return kUsage;
  } catch (const sweepd::ConfigError& problem) {
    return say(problem, kConfigError);
  } catch (const rsi::EthernetConfigError& problem) {
    return say(problem, kConfigError);
  } catch (const std::invalid_argument& problem) {
    return say(problem, kUsage);
  } catch (const std::exception& problem) {
    return say(problem, kFailed);
  }
}
