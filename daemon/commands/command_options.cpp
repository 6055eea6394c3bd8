#include "daemon/commands/command_options.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/points/axes_file.hpp"
#include "daemon/points/point_columns.hpp"
#include "identify/sweeps/sample.hpp"

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

void add_force(CLI::App& command, bool& force) {
  command.add_flag("--force", force,
                   "Overwrite what is not of sweepd, or was edited; never what is read");
}

void add_traces(CLI::App& command, std::vector<std::filesystem::path>& traces) {
  command.add_option("TRACE", traces, "Captures of one stream: all parts of a trace, in any order")
      ->required()
      ->type_name("");
}

}  // namespace

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
  add_force(*command, options.force);
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
  add_force(*command, options.force);
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
  add_force(*command, options.force);
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
  command
      ->add_option_function<std::string>(
          "--check",
          [&options](const std::string& rule) {
            options.check = rule == "sweepd" ? rsi::ReplyRule::sweepd : rsi::ReplyRule::controller;
          },
          "What replies must be: what a controller accepts (Type and IPOC are right, tags may be "
          "missing), or what sweepd promises (every tag of RECEIVE is there and zero) (default: "
          "controller)")
      ->type_name("controller|sweepd")
      ->check(CLI::IsMember({"controller", "sweepd"}));
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
  add_force(*command, options.force);
  return command;
}

CLI::App* add_plan(CLI::App& app, PlanOptions& options) {
  auto* command = app.add_subcommand(
      "plan",
      "Before the robot moves: checks a sweep plan, predicts the uncertainty of every DH "
      "parameter, proposes better ranges, writes the robot's program");
  command->add_option("--robot", options.robot, "Robot description")->required()->type_name("FILE");
  command->add_option("--plan", options.plan, "Sweep plan")->required()->type_name("FILE");
  command->add_option("--cycle-ms", options.cycle_ms, "4 on IPO_FAST, 12 on IPO")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--precision", options.precision, "Decimals, as at the ETHERNET object")
      ->check(CLI::Range(0, 15))
      ->capture_default_str();
  command->add_option("--wobble-deg", options.wobble_deg, "Servo wobble of every joint, sigma")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--position-sigma-mm", options.position_sigma_mm,
                   "Another device measures positions, so well in each coordinate, and no angles "
                   "(default: the controller's own numbers are used)")
      ->check(CLI::Range(1e-6, 100.0));
  command
      ->add_option("--tool-mm", options.tool_mm,
                   "Target point in the frame after the last row (default: the description's)")
      ->type_name("X,Y,Z")
      ->delimiter(',');
  auto* propose = command->add_flag("--propose", options.propose,
                                    "Look for better ranges within the joint limits");
  command
      ->add_option("--margin-deg", options.margin_deg, "Proposed ranges keep so far off the limits")
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  command->add_option("--write-plan", options.write_plan, "Write the proposed plan")
      ->type_name("FILE")
      ->needs(propose);
  auto* krl = command
                  ->add_option_function<std::string>(
                      "--krl",
                      [&options](const std::string& dialect) {
                        options.krl = dialect == "krc2"   ? KrlDialect::krc2
                                      : dialect == "krc4" ? KrlDialect::krc4
                                                          : KrlDialect::iiqka;
                      },
                      "Write the KRL program of --plan: for KR C2 (RSI 2), KR C4 and KR C5 with "
                      "KSS (RSI 3 to 5), or KR C5 with iiQKA (RSI 6)")
                  ->type_name("krc2|krc4|iiqka")
                  ->check(CLI::IsMember({"krc2", "krc4", "iiqka"}));
  auto* output = command->add_option("--output", options.output, "Folder for NAME.src, NAME.dat")
                     ->type_name("DIR")
                     ->needs(krl);
  krl->needs(output);
  command->add_option("--name", options.name, "Of the KRL program")
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option("--krl-tool", options.krl_tool,
                   "Number of the controller's tool whose point is the target")
      ->capture_default_str();
  command
      ->add_option("--rsi-file", options.rsi_file,
                   "Ethernet file (krc2) or RSI context (krc4, iiqka) that the KRL program names "
                   "(default: sweepd_udp.xml, sweepd.rsi, sweepd)")
      ->type_name("NAME");
  add_force(*command, options.force);
  command->footer(
      "The plan is rehearsed by a simulated robot; the uncertainties are those of the Fisher\n"
      "information of the samples that the estimator would use.\n"
      "sweepd knows joint limits, but neither the cell nor the robot's own body: run every new\n"
      "plan in T1 first.\n"
      "Exit codes: 0 done; 1 refused, and nothing is written: an axis would not be determined, or\n"
      "a sweep not be recognised; 78 beyond the limits of the robot, all findings are listed.");
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
  add_force(*command, options.force);
  return command;
}

CLI::App* add_check(CLI::App& app, CheckOptions& options) {
  auto* command = app.add_subcommand(
      "check", "Settings, robot, plan, the controller's files and this machine against each other");
  command
      ->add_option("--config", options.config,
                   "Settings, and all files that they name (default, unless other files are given: "
                   "those of `run`)")
      ->type_name("FILE");
  command->add_option("--ethernet-config", options.ethernet_configs, "Ethernet files by themselves")
      ->type_name("FILE");
  command
      ->add_option("--context", options.contexts,
                   "RSI contexts of the controller (.rsi.xml or .rsix), to be held against the "
                   "Ethernet files")
      ->type_name("FILE");
  command->add_flag("--files-only", options.files_only,
                    "Leave this machine alone: port, addresses, real time, disk");
  command->footer(
      "Best as the user that serves: sudo -u sweepd sweepd check.\n"
      "Exit codes: 0 nothing wrong (there may be warnings), 78 a file is wrong, 1 the files are\n"
      "right but this machine cannot do what they say.");
  return command;
}

}  // namespace sweepd
