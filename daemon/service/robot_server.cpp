#include "daemon/service/robot_server.hpp"

#include <utility>

#include <spdlog/fmt/ranges.h>

#include "daemon/settings/answers.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/log.hpp"
#include "rsi/server/tap.hpp"
#include "rsi/server/tcp_server.hpp"
#include "rsi/server/udp_server.hpp"

namespace sweepd {
namespace {

/// Replies are as the Ethernet file says, or where there is none, expected.
std::unique_ptr<rsi::Server> make_tap(const RobotSettings& settings,
                                      const std::optional<rsi::EthernetConfig>& config,
                                      rsi::Server::Options options) {
  rsi::Tap::Settings tap;
  tap.capture.interface = settings.tap->interface;
  tap.capture.promiscuous = settings.tap->promiscuous;
  if (config) {
    if (config->protocol == rsi::EthernetConfig::Protocol::TCP) tap.transport = rsi::Transport::tcp;
    tap.replies = !config->only_send;
  }
  return std::make_unique<rsi::Tap>(std::move(tap), std::move(options));
}

}  // namespace

std::optional<rsi::EthernetConfig> ethernet_config_of(const RobotSettings& settings) {
  if (!settings.ethernet_config) return std::nullopt;
  auto config = rsi::EthernetConfig::load(*settings.ethernet_config);
  if (!settings.tap)
    for (const auto& objection : objections_to_answers(settings, config))
      throw ConfigError(objection);
  return config;
}

std::unique_ptr<rsi::Server> make_server(const RobotSettings& settings) {
  const Log log(settings.name);
  rsi::Server::Options options;
  options.listen = settings.listen;
  options.controller = settings.controller;
  options.queue_bytes = settings.queue_bytes;
  const auto found = ethernet_config_of(settings);
  if (settings.tap) return make_tap(settings, found, std::move(options));
  // Warnings come after the port: until it is had, this is tried again and again.
  if (!found) {
    options.reply.emplace("ImFree");
    auto server = std::make_unique<rsi::UdpServer>(std::move(options));
    log.warning("no ethernet_config: {}", kWithoutEthernetConfig);
    return server;
  }
  const rsi::EthernetConfig& config = *found;
  if (!config.only_send) options.reply.emplace(config);
  const auto tags = commanding_tags(config);
  options.only_from_the_beginning = !tags.empty();
  std::unique_ptr<rsi::Server> server;
  if (config.protocol == rsi::EthernetConfig::Protocol::TCP)
    server = std::make_unique<rsi::TcpServer>(std::move(options));
  else
    server = std::make_unique<rsi::UdpServer>(std::move(options));
  for (const auto& warning : config.warnings) log.warning("{}", warning);
  for (const auto& warning : warnings_of_answers(config)) log.warning("{}", warning);
  if (config.port != 0 && settings.listen.port != 0 && config.port != settings.listen.port)
    log.warning("the controller sends to port {}, but listen is {}: make them equal", config.port,
                rsi::text(settings.listen));
  if (!tags.empty())
    log.warning(
        "zeros for {} may move the robot or switch something: only streams whose beginning was "
        "seen are answered",
        fmt::join(tags, ", "));
  return server;
}

RealTimeReport ReplyThread::start(const RealTimeSettings& wish) {
  std::promise<RealTimeReport> ready;
  auto report = ready.get_future();
  thread_ = std::thread(
      [this, wish, ready = std::move(ready)]() mutable { serve(wish, std::move(ready)); });
  return report.get();
}

void ReplyThread::stop() {
  if (!runs()) return;
  server_.stop();
  thread_.join();
}

void ReplyThread::serve(const RealTimeSettings& wish, std::promise<RealTimeReport> ready) {
  name_thread("reply");
  RealTimeReport report;
  if (wish.wish != RealTime::off) lock_memory(report);
  enter_real_time(wish, report);
  server_.warm();
  ready.set_value(std::move(report));
  server_.run();
}

}  // namespace sweepd
