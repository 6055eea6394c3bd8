#include "daemon/robot_server.hpp"

#include <utility>

#include <spdlog/fmt/ranges.h>

#include "daemon/answers.hpp"
#include "daemon/config_error.hpp"
#include "daemon/log.hpp"
#include "rsi/ethernet_config.hpp"
#include "rsi/tcp_server.hpp"
#include "rsi/udp_server.hpp"

namespace sweepd {

std::unique_ptr<rsi::Server> make_server(const RobotSettings& settings) {
  const Log log(settings.name);
  rsi::Server::Options options;
  options.listen = settings.listen;
  options.controller = settings.controller;
  options.queue_bytes = settings.queue_bytes;
  if (!settings.ethernet_config) {
    options.reply.emplace("ImFree");
    log.warning(
        "no ethernet_config: replies carry Type ImFree and the IPOC alone; name the file that lies "
        "on the controller");
    return std::make_unique<rsi::UdpServer>(std::move(options));
  }
  const auto config = rsi::EthernetConfig::load(*settings.ethernet_config);
  for (const auto& objection : objections_to_answers(settings, config))
    throw ConfigError(objection);
  for (const auto& warning : config.warnings) log.warning("{}", warning);
  for (const auto& warning : warnings_of_answers(config)) log.warning("{}", warning);
  if (config.port != 0 && settings.listen.port != 0 && config.port != settings.listen.port)
    log.warning("the controller sends to port {}, but listen is {}: make them equal", config.port,
                rsi::text(settings.listen));
  if (!config.only_send) options.reply.emplace(config);
  if (const auto tags = commanding_tags(config); !tags.empty()) {
    options.only_from_the_beginning = true;
    log.warning(
        "zeros for {} may move the robot or switch something: only streams whose beginning was "
        "seen "
        "are answered",
        fmt::join(tags, ", "));
  }
  if (config.protocol == rsi::EthernetConfig::Protocol::TCP)
    return std::make_unique<rsi::TcpServer>(std::move(options));
  return std::make_unique<rsi::UdpServer>(std::move(options));
}

}  // namespace sweepd
