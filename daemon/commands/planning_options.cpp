#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <tuple>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"

namespace sweepd {
namespace {

void add_robot_and_plan(CLI::App& command, std::filesystem::path& robot,
                        std::filesystem::path& plan) {
  command.add_option("--robot", robot, "Read the robot description from this file")
      ->required()
      ->type_name("FILE");
  command.add_option("--plan", plan, "Read the sweep plan from this file")
      ->required()
      ->type_name("FILE");
}

void add_tool(CLI::App& command, std::optional<std::array<double, 3>>& tool_mm) {
  command
      .add_option("--tool-mm", tool_mm,
                  "Place the target at this point, in mm, of the frame after the last DH row")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->default_str("that of the robot description");
}

}  // namespace

CLI::App* add_simulate(CLI::App& app, SimulateOptions& options) {
  auto* command = app.add_subcommand(
      "simulate",
      "Simulate a controller whose robot runs a sweep plan, and check an RSI server's replies\n"
      "The telegrams go to a server in real time, or into a capture. The same options make the "
      "same telegrams.");
  add_robot_and_plan(*command, options.robot, options.plan);
  auto* target = command->add_option_group("Target");
  target
      ->add_option("--to", parsed(options.to, rsi::parse_endpoint),
                   "Send the telegrams to the RSI server at this IPv4 address and port in real "
                   "time, over TCP where the Ethernet file says so and else over UDP")
      ->type_name("ADDRESS:PORT");
  target
      ->add_option("--write", options.write,
                   "Write the telegrams to this capture as fast as possible")
      ->type_name("TRACE.pcap");
  target->require_option(1);
  command
      ->add_option("--ethernet-config", options.ethernet_config,
                   "Read the controller's Ethernet file from here")
      ->type_name("FILE")
      ->default_str("the one that sweepd ships");
  command
      ->add_option("--seed", options.seed,
                   "Start the random numbers of wobble and faults from this number")
      ->capture_default_str();
  command
      ->add_option("--wobble-deg", options.wobble_deg,
                   "Let every joint wobble with this standard deviation, in degrees")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--precision", options.precision,
                   "Write numbers with this many decimals, as set at the ETHERNET object")
      ->check(CLI::Range(0, 15))
      ->capture_default_str();
  command
      ->add_option("--cycle-ms", options.cycle_ms,
                   "Send a telegram every so many milliseconds: 4 on IPO_FAST, 12 on IPO")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--timeout-cycles", options.timeout_cycles,
                   "Stop after this many unanswered cycles in a row, as a controller does")
      ->capture_default_str();
  command
      ->add_option_function<std::string>(
          "--check",
          [&options](const std::string& rule) {
            options.check = rule == "sweepd" ? rsi::ReplyRule::sweepd : rsi::ReplyRule::controller;
          },
          "Accept what a controller accepts (Type and IPOC are right, tags may be missing), or "
          "only what sweepd promises (every tag of RECEIVE is there and zero)")
      ->type_name("controller|sweepd")
      ->check(CLI::IsMember({"controller", "sweepd"}))
      ->default_str("controller");
  command->add_option("--first-ipoc", options.first_ipoc, "Give the first telegram this IPOC")
      ->capture_default_str();
  for (const auto& [name, value, help] :
       {std::tuple{"--lose-percent", &options.lose_percent,
                   "Lose this share of the telegrams on purpose, in percent"},
        std::tuple{"--duplicate-percent", &options.duplicate_percent,
                   "Send this share of the telegrams twice, in percent"},
        std::tuple{"--swap-percent", &options.swap_percent,
                   "Exchange this share of the telegrams with the next one, in percent"}})
    command->add_option(name, *value, help)->check(CLI::Range(0.0, 100.0))->capture_default_str();
  add_tool(*command, options.tool_mm);
  add_quiet(*command, options.quiet);
  add_force(*command, options.force);
  command->footer(
      exit_status({{0, "The plan was played to its end, and every reply was right and in time."},
                   kError,
                   kWrongUsage,
                   {kLate,
                    "Every reply was right, but some came late or not at all, as from a busy "
                    "machine."},
                   kWrongFile}));
  return command;
}

CLI::App* add_plan(CLI::App& app, PlanOptions& options) {
  auto* command = app.add_subcommand(
      "plan",
      "Check a sweep plan before the robot moves: predict uncertainties, propose better ranges, "
      "write the KRL program\n"
      "A simulated robot rehearses the plan. The uncertainties are those of the Fisher information "
      "of the samples that the estimator would use.\n"
      "sweepd knows joint limits, but neither the cell nor the robot's own body: run every new "
      "plan in T1 first.");
  add_robot_and_plan(*command, options.robot, options.plan);
  command
      ->add_option("--cycle-ms", options.cycle_ms,
                   "Assume a telegram every so many milliseconds: 4 on IPO_FAST, 12 on IPO")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--precision", options.precision,
                   "Assume numbers with this many decimals, as set at the ETHERNET object")
      ->check(CLI::Range(0, 15))
      ->capture_default_str();
  command
      ->add_option("--wobble-deg", options.wobble_deg,
                   "Assume that every joint wobbles with this standard deviation, in degrees")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--position-sigma-mm", options.position_sigma_mm,
                   "Assume that another device measures positions and no angles, with this "
                   "standard deviation of each coordinate in mm")
      ->check(CLI::Range(1e-6, 100.0))
      ->default_str("positions and angles are the controller's");
  add_tool(*command, options.tool_mm);
  auto* propose = command->add_flag("--propose", options.propose,
                                    "Look for better sweep ranges within the joint limits");
  command
      ->add_option("--margin-deg", options.margin_deg,
                   "Keep proposed ranges this many degrees off the joint limits")
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  command->add_option("--write-plan", options.write_plan, "Write the proposed plan to this file")
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
                      "Write the KRL program of the plan that was given, for a KR C2 (krc2: RSI "
                      "2), a KR C4 or KR C5 with KSS (krc4: RSI 3 to 5), or a KR C5 with iiQKA "
                      "(iiqka: RSI 6)")
                  ->type_name("krc2|krc4|iiqka")
                  ->check(CLI::IsMember({"krc2", "krc4", "iiqka"}));
  auto* output =
      command
          ->add_option("--output", options.output,
                       "Write the KRL program into this folder, as NAME.src and NAME.dat")
          ->type_name("DIR")
          ->needs(krl);
  krl->needs(output);
  command->add_option("--name", options.name, "Give the KRL program this name")
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option("--krl-tool", options.krl_tool,
                   "Use the controller's tool of this number in the KRL program, whose point is "
                   "the target")
      ->capture_default_str();
  command
      ->add_option("--rsi-file", options.rsi_file,
                   "Let the KRL program load this Ethernet file (krc2) or RSI context (krc4, "
                   "iiqka)")
      ->type_name("NAME")
      ->default_str("sweepd_udp.xml, sweepd.rsi or sweepd");
  add_force(*command, options.force);
  command->footer(exit_status(
      {kOk,
       {kFailed,
        "The plan is refused and nothing is written: an axis would not be determined, or a sweep "
        "not be recognised. Or a file cannot be written."},
       kWrongUsage,
       {kConfigError,
        "A configuration file is wrong, or the plan goes beyond the limits of the robot. All "
        "findings are listed."}}));
  return command;
}

}  // namespace sweepd
