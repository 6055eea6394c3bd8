#include "daemon/commands/simulate_command.hpp"

#include <atomic>
#include <csignal>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/commands/simulation_report.hpp"
#include "daemon/plan/simulated_robot.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/progress.hpp"
#include "rsi/capture/capture_writer.hpp"

namespace sweepd {
namespace {

using rsi::ControllerLink;
using rsi::EthernetConfig;

/// From the beginning to the end of its life SIGINT and SIGTERM are noted instead of killing; a
/// second one kills.
class Interrupt {
 public:
  Interrupt() {
    caught_ = false;
    struct sigaction action {};
    action.sa_handler = [](int signal) {
      if (caught_.exchange(true)) end_by(signal);
    };
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
  }
  ~Interrupt() {
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
  }
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  [[nodiscard]] bool caught() const { return caught_; }

 private:
  static inline std::atomic<bool> caught_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
  struct sigaction old_int_ {};
  struct sigaction old_term_ {};
};

/// config/controller/krc4/sweepd_ethernet.xml
EthernetConfig built_in_ethernet_config() {
  using Type = EthernetConfig::Element::Type;
  EthernetConfig config;
  config.name = "built-in Ethernet file";
  config.ip_number = "192.168.1.10";
  config.port = 49152;
  config.sentype = "ImFree";
  for (const char* tag : {"DEF_RIst", "DEF_RSol", "DEF_AIPos", "DEF_ASPos", "DEF_MACur"})
    config.send.push_back({tag, Type::DOUBLE, 0, false, 0});
  config.send.push_back({"DEF_Delay", Type::LONG, 0, false, 0});
  config.receive.push_back({"DEF_EStr", Type::STRING, 0, false, 0});
  return config;
}

/// Of captures that are written here, so that the same options write the same bytes:
/// 2025-01-01T00:00:00Z.
constexpr std::chrono::seconds kStart{1'735'689'600};

/// What such a capture begins with: no recording does.
std::string simulated_capture_begins() {
  rsi::Datagram first;
  first.time = kStart;
  std::string bytes = rsi::capture_header();
  const auto header = bytes.size();
  constexpr std::size_t kSecondsAndNanoseconds = 8;
  rsi::append_capture_record(first, bytes);
  return bytes.substr(0, header + kSecondsAndNanoseconds);
}

/// A run of the command.
class Simulation {
 public:
  Simulation(const SimulateOptions& options, std::ostream& report, std::ostream& errors)
      : options_(options),
        ethernet_(options.ethernet_config ? EthernetConfig::load(*options.ethernet_config)
                                          : built_in_ethernet_config()),
        cycle_(options.cycle_ms),
        faults_{.lose = options.lose_percent / 100,
                .duplicate = options.duplicate_percent / 100,
                .swap = options.swap_percent / 100},
        robot_(load_robot(options.robot), load_plan(options.plan), robot_options(options)),
        progress_("simulate", options.quiet ? Progress::Terminal{} : Progress::standard_error()),
        report_(report),
        errors_(errors) {}

  int to_server();
  int to_capture();

 private:
  static SimulatedRobot::Options robot_options(const SimulateOptions& options);
  bool next(std::uint64_t cycle, rsi::SignalValues& values);
  [[nodiscard]] SimulationReport report_to(std::string target) const;
  int finish(const SimulationReport& report, const std::string& problem);

  const SimulateOptions& options_;
  EthernetConfig ethernet_;
  std::chrono::milliseconds cycle_;
  rsi::FaultyWire::Rates faults_;
  SimulatedRobot robot_;
  Interrupt interrupt_;
  bool interrupted_ = false;  // before the plan was over
  Progress progress_;
  std::ostream& report_;
  std::ostream& errors_;
};

SimulatedRobot::Options Simulation::robot_options(const SimulateOptions& options) {
  SimulatedRobot::Options robot{.cycle = std::chrono::milliseconds(options.cycle_ms),
                                .wobble_deg = options.wobble_deg,
                                .seed = options.seed,
                                .tool_mm = {}};
  if (options.tool_mm) robot.tool_mm = Eigen::Vector3d(options.tool_mm->data());
  return robot;
}

bool Simulation::next(std::uint64_t cycle, rsi::SignalValues& values) {
  if (!robot_.next(values)) return false;
  interrupted_ = interrupt_.caught();
  progress_.update(static_cast<double>(cycle), static_cast<double>(robot_.cycles()),
                   "joint " + std::to_string(robot_.joint()));
  return !interrupted_;
}

SimulationReport Simulation::report_to(std::string target) const {
  SimulationReport report;
  report.target = std::move(target);
  report.cycle = cycle_;
  report.planned = robot_.cycles();
  report.only_send = ethernet_.only_send;
  report.interrupted = interrupted_;
  report.swaps = faults_.swap > 0;
  return report;
}

int Simulation::to_server() {
  ControllerLink::Options link_options;
  link_options.controller = {.server = *options_.to,
                             .cycle = cycle_,
                             .first_ipoc = options_.first_ipoc,
                             .precision = options_.precision,
                             .timeout = options_.timeout_cycles,
                             .rule = options_.check};
  link_options.faults = faults_;
  link_options.seed = options_.seed;
  ControllerLink link(ethernet_, link_options);
  // Progress is drawn before a telegram goes out: there it cannot lengthen the latency measured.
  auto result = link.run(
      [this](std::uint64_t cycle, rsi::SignalValues& values) { return next(cycle, values); });
  auto report = report_to(rsi::text(*options_.to));
  report.live = true;
  report.link = std::move(result);
  return finish(report, problem(report));
}

int Simulation::to_capture() {
  rsi::Datagram datagram;
  datagram.source = *rsi::parse_endpoint("192.168.1.20:49153");
  datagram.destination = {*rsi::parse_address("192.168.1.10"), ethernet_.port};

  const rsi::TelegramWriter writer(ethernet_, options_.precision);
  rsi::FaultyWire wire(faults_, options_.seed);
  OutputFile output(*options_.write);
  rsi::CaptureWriter capture(output.beside());
  const auto record = [&](const std::vector<rsi::Sent>& datagrams) {
    for (const auto& sent : datagrams) {
      datagram.payload = sent.payload;
      capture.write(datagram);
    }
  };

  rsi::SignalValues values;
  std::string telegram;
  std::uint64_t telegrams = 0;
  std::chrono::milliseconds since_start{0};
  for (; capture.error().empty() && next(telegrams, values); ++telegrams, since_start += cycle_) {
    telegram.clear();
    writer.append(telegram, values,
                  options_.first_ipoc + static_cast<std::uint64_t>(since_start.count()));
    datagram.time = kStart + since_start;
    record(wire.pass(telegram));
  }
  datagram.time = kStart + since_start;
  record(wire.flush());
  if (capture.flush() && !interrupted_) output.commit();

  auto report = report_to(options_.write->string());
  report.link.controller.telegrams = telegrams;
  report.link.wire = wire.counts();
  return finish(report, capture.error().empty() ? problem(report) : capture.error());
}

int Simulation::finish(const SimulationReport& report, const std::string& problem) {
  progress_.clear();
  if (!options_.quiet) report_ << text(report) << std::flush;
  if (problem.empty()) return 0;
  errors_ << "sweepd: " + problem + '\n' << std::flush;
  return only_late(report) ? kAdverse : kFailed;
}

}  // namespace

int simulate(const SimulateOptions& options, std::ostream& report, std::ostream& errors) {
  if (options.to.has_value() == options.write.has_value())
    throw std::invalid_argument("simulate: expected either a server or a capture to write");
  if (options.write) {
    std::vector<std::filesystem::path> inputs{options.robot, options.plan};
    if (options.ethernet_config) inputs.push_back(*options.ethernet_config);
    Outputs(std::move(inputs), options.force).check(*options.write, simulated_capture_begins());
  }
  Simulation simulation(options, report, errors);
  return options.to ? simulation.to_server() : simulation.to_capture();
}

CLI::App* add_simulate(CLI::App& app, SimulateOptions& options) {
  auto* command = app.add_subcommand(
      "simulate",
      "Simulate a controller whose robot runs a sweep plan, and check an RSI server's replies\n"
      "The telegrams go to a server in real time, or into a capture. The same options make the "
      "same telegrams.");
  add_robot(*command, options.robot);
  command->add_option("--plan", options.plan, "Read the sweep plan from this file")
      ->required()
      ->type_name("FILE");
  auto* target = command->add_option_group("Target");
  auto* to =
      target
          ->add_option("--to", parsed(options.to, rsi::parse_endpoint, "--to", kAnEndpoint),
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
  add_number(*command, "--seed", options.seed, whole_number(0),
             "Start the random numbers of wobble and faults from this number");
  add_number(*command, "--wobble-deg", options.wobble_deg, number_between(0.0, kMostWobble_deg),
             "Let every joint wobble with this standard deviation, in degrees");
  add_number(*command, "--precision", options.precision, whole_number(0, rsi::kMostPrecision),
             "Write numbers with this many decimals, as set at the ETHERNET object");
  add_number(*command, "--cycle-ms", options.cycle_ms, whole_number(1, 1000),
             "Send a telegram every so many milliseconds: 4 on IPO_FAST, 12 on IPO");
  add_number(*command, "--timeout-cycles", options.timeout_cycles, whole_number(1),
             "Stop after this many unanswered cycles in a row, as a controller does")
      ->needs(to);
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
      ->needs(to)
      ->default_str("controller");
  add_number(*command, "--first-ipoc", options.first_ipoc, whole_number(0),
             "Give the first telegram this IPOC");
  const auto percent = number_between(0.0, 100.0);
  add_number(*command, "--lose-percent", options.lose_percent, percent,
             "Lose this share of the telegrams on purpose, in percent");
  add_number(*command, "--duplicate-percent", options.duplicate_percent, percent,
             "Send this share of the telegrams twice, in percent");
  add_number(*command, "--swap-percent", options.swap_percent, percent,
             "Exchange this share of the telegrams with the next one, in percent");
  add_tool(*command, options.tool_mm);
  add_quiet(*command, options.quiet);
  add_force(*command, options.force);
  command->footer(
      exit_status({{0, "The plan was played to its end, and every reply was right and in time."},
                   kError,
                   kWrongUsage,
                   {kAdverse,
                    "Every reply was right, but some came late or not at all, as from a busy "
                    "machine."},
                   kWrongFile}));
  return command;
}

}  // namespace sweepd
