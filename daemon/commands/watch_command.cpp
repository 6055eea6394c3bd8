#include "daemon/commands/watch_command.hpp"

#include <chrono>
#include <csignal>
#include <map>
#include <utility>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/run_command.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/process_events.hpp"
#include "rsi/capture/conversation.hpp"
#include "rsi/capture/live_capture.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

rsi::LiveCapture::Options capture_of(const WatchOptions& options) {
  rsi::LiveCapture::Options capture;
  capture.interface = options.interface;
  capture.promiscuous = options.promiscuous;
  return capture;
}

/// Where RSI goes to on this interface: waits for the first conversation of which some telegrams
/// pass. Nothing once a signal ends it.
std::optional<rsi::Conversation> find_rsi(const WatchOptions& options) {
  constexpr std::size_t kMost = 64;
  constexpr auto kWord = 10s;
  ProcessEvents events{SIGINT, SIGTERM};
  rsi::LiveCapture capture(capture_of(options));
  Log().note("looking for RSI on {}", options.interface);
  std::map<rsi::Conversation, int> seen;
  std::uint64_t datagrams = 0;
  auto word = Steady::now() + kWord;
  while (!events.next_signal()) {
    log_repeats();
    events.wait_until(Steady::now());  // lets signals in
    rsi::Datagram datagram;
    rsi::PacketHeaders headers;
    const auto look = capture.next(datagram, headers);
    if (look == rsi::LiveCapture::Look::gone)
      throw std::runtime_error("interface " + options.interface +
                               " is gone or down: see `ip link`, and start this again");
    if (look == rsi::LiveCapture::Look::datagram || look == rsi::LiveCapture::Look::segment) {
      ++datagrams;
      const rsi::Conversation conversation{datagram.source.address, datagram.destination};
      const bool counts = rsi::looks_like_telegram(datagram.payload) &&
                          (seen.size() < kMost || seen.contains(conversation));
      if (counts && ++seen[conversation] == rsi::kSurelyRsi) {
        Log().note("RSI of {}", text(conversation));
        return conversation;
      }
    }
    if (Steady::now() < word) continue;
    word = Steady::now() + 6 * kWord;
    Log().warning(
        "no RSI on {} yet, {} other packets: is RSI on, is this the interface, does the "
        "switch mirror the controller's port?",
        options.interface, datagrams);
  }
  return std::nullopt;
}

/// Of a robot that no settings know.
Settings settings_for(const WatchOptions& options, const rsi::Endpoint& watched) {
  RobotSettings robot;
  robot.name = load_setup(options.robot, options.plan).name;
  robot.description = options.robot.value_or("");
  robot.plan = options.plan;
  robot.listen = watched;
  robot.output = ".";
  Settings settings;
  settings.robots.push_back(std::move(robot));
  settings.http.listen.reset();
  return settings;
}

Settings watched_settings(const WatchOptions& options) {
  Settings settings = load_settings(*options.config);
  if (options.port)
    std::erase_if(settings.robots,
                  [&](const RobotSettings& robot) { return robot.listen.port != *options.port; });
  if (settings.robots.empty())
    throw ConfigError(options.config->string() + ": listen: expected a [[robot]] with port " +
                      std::to_string(*options.port) +
                      ", found none: name one, or leave out --port");
  if (settings.robots.size() > 1 && (options.robot || options.plan))
    throw ConfigError(options.config->string() +
                      ": expected one [[robot]] with --robot or --plan, found " +
                      std::to_string(settings.robots.size()) + ": choose one with --port");
  for (RobotSettings& robot : settings.robots) {
    if (options.robot) robot.description = *options.robot;
    if (options.plan) robot.plan = options.plan;
  }
  return settings;
}

/// Whoever answers the controller may be on this machine: nothing is taken from it.
Settings watching(Settings settings, const WatchOptions& options) {
  for (RobotSettings& robot : settings.robots) {
    if (options.output) robot.output = *options.output;
    robot.tap = TapSettings{options.interface, options.promiscuous};
    robot.real_time = {};
    robot.real_time.wish = RealTime::off;
  }
  return settings;
}

}  // namespace

int watch(const WatchOptions& options) {
  if (options.config)
    return serve_robots([options] { return watching(watched_settings(options), options); });
  static_cast<void>(load_setup(options.robot, options.plan));  // before RSI has to come for it
  std::optional<rsi::Endpoint> watched;
  if (options.port) {
    watched = rsi::Endpoint{0, *options.port};
  } else if (const auto found = find_rsi(options)) {
    watched = found->sweepd;
  }
  if (!watched) return 0;
  return serve_robots(
      [options, at = *watched] { return watching(settings_for(options, at), options); });
}

CLI::App* add_watch(CLI::App& app, WatchOptions& options) {
  auto* command = app.add_subcommand(
      "watch",
      "Listen to RSI that another program answers: record it, judge the link, identify the robot\n"
      "It sends nothing. Run it on the machine of that program, or where a switch mirrors the "
      "controller's port. It takes CAP_NET_RAW, and stays in the foreground until SIGTERM or "
      "SIGINT.");
  command->add_option("--interface", options.interface, "Listen on this network interface")
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option("--port", options.port,
                   "Watch this port. With --config, only the robots that listen on it")
      ->check(whole_number(1, 65535))
      ->default_str("the robots of the settings, or where RSI goes to");
  command
      ->add_option("--config", options.config,
                   "Watch the robots of these settings, each by the port of its `listen`")
      ->type_name("FILE")
      ->default_str("no settings");
  add_setup(*command, options.robot, options.plan);
  command->add_option("--output", options.output, "Keep recordings and results below this folder")
      ->type_name("DIR")
      ->default_str("the `output` of the settings, or this folder");
  command->add_flag("--promiscuous", options.promiscuous,
                    "See what is not for this machine, too, as on a mirror port");
  command->footer(exit_status({kOk, kError, kWrongUsage, kWrongFile}));
  return command;
}

}  // namespace sweepd
