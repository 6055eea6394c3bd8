#include "daemon/run_command.hpp"

#include <csignal>
#include <list>

#include <spdlog/spdlog.h>

#include "daemon/config_error.hpp"
#include "daemon/robot_service.hpp"
#include "daemon/settings.hpp"

namespace sweepd {

int run(const RunOptions& options) {
  Settings settings = load_settings(options.config);
  if (options.listen && settings.robots.size() > 1)
    throw ConfigError(settings.file.string() +
                      ": listen: expected one [[robot]] with --listen, found " +
                      std::to_string(settings.robots.size()) +
                      ": set `listen` of each robot in the file instead");
  // Every thread inherits the mask: the signals are this thread's to wait for.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  std::list<RobotService> services;
  for (RobotSettings& robot : settings.robots) {
    if (options.output) robot.output = *options.output;
    if (options.listen) robot.listen = *options.listen;
    services.emplace_back(robot);
  }
  for (RobotService& service : services) service.start();

  int signal = 0;
  sigwait(&signals, &signal);
  spdlog::info("ending on {}", signal == SIGINT ? "SIGINT" : "SIGTERM");
  for (RobotService& service : services) service.stop();
  return 0;
}

}  // namespace sweepd
