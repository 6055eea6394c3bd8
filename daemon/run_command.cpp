#include "daemon/run_command.hpp"

#include <csignal>
#include <cstdlib>
#include <map>
#include <set>
#include <string>

#include "daemon/config_error.hpp"
#include "daemon/heartbeat.hpp"
#include "daemon/log.hpp"
#include "daemon/realtime.hpp"
#include "daemon/robot_service.hpp"
#include "daemon/service_manager.hpp"
#include "daemon/settings.hpp"

namespace sweepd {
namespace {

Settings read_settings(const RunOptions& options) {
  Settings settings = load_settings(options.config);
  if (options.listen && settings.robots.size() > 1)
    throw ConfigError(settings.file.string() +
                      ": listen: expected one [[robot]] with --listen, found " +
                      std::to_string(settings.robots.size()) +
                      ": set `listen` of each robot in the file instead");
  for (RobotSettings& robot : settings.robots) {
    if (options.output) robot.output = *options.output;
    if (options.listen) robot.listen = *options.listen;
  }
  return settings;
}

/// The robots that are served, by name.
using Services = std::map<std::string, RobotService>;

/// Robots that went are let go, those that came are served, the others take over what they can. A
/// file with a mistake changes nothing.
void reload(const RunOptions& options, Services& services) {
  const Log log;
  log.note("reading {} again", options.config.string());
  service_manager::reloading();
  try {
    const Settings settings = read_settings(options);
    std::set<std::string> names;
    for (const RobotSettings& robot : settings.robots) names.insert(robot.name);
    std::erase_if(services, [&](const auto& service) {
      const bool gone = !names.contains(service.first);
      if (gone) Log(service.first).note("no longer in the settings: it is not served any more");
      return gone;
    });
    for (const RobotSettings& robot : settings.robots) {
      const auto service = services.find(robot.name);
      try {
        if (service != services.end()) {
          service->second.reload(robot);
        } else {
          leave_processors(robot.real_time.cpus);
          services.try_emplace(robot.name, robot).first->second.start();
        }
      } catch (const std::exception& error) {
        Log(robot.name).error("{}", error.what());
        if (service == services.end()) services.erase(robot.name);
      }
    }
  } catch (const std::exception& error) {
    log.error("{}; sweepd goes on with the settings that it had", error.what());
  }
  service_manager::ready();
}

/// Looks after the services now and then: systemd hears that they are alive only while they are.
class Watch {
 public:
  void look(const Services& services) {
    log_repeats();
    std::vector<Heartbeat::Beats> beats;
    for (const auto& [name, service] : services) beats.push_back(service.beats());
    const auto now = std::chrono::steady_clock::now();
    const auto still = heartbeat_.look(beats, now);
    for (const auto& standstill : still)
      Log().error("{}: replies may stop; see what the machine waits for", text(standstill, now));
    if (still.empty()) service_manager::beat();
  }

 private:
  Heartbeat heartbeat_;
};

}  // namespace

int run(const RunOptions& options) {
  const Settings settings = read_settings(options);
  // Every thread inherits the mask: the signals are this thread's to wait for.
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  // What all other threads inherit: each reply thread chooses its own.
  for (const RobotSettings& robot : settings.robots) leave_processors(robot.real_time.cpus);
  Services services;
  for (const RobotSettings& robot : settings.robots) services.try_emplace(robot.name, robot);
  for (auto& [name, service] : services) service.start();

  service_manager::ready();
  Watch watch;
  constexpr timespec kOften{.tv_sec = 1, .tv_nsec = 0};
  int signal = 0;
  while (signal != SIGINT && signal != SIGTERM) {
    watch.look(services);
    signal = sigtimedwait(&signals, nullptr, &kOften);  // -1: none came
    if (signal == SIGHUP) reload(options, services);
    if (signal == SIGUSR1)
      for (auto& [name, service] : services) service.report_link();
  }
  service_manager::stopping();
  Log().note("ending on {}", signal == SIGINT ? "SIGINT" : "SIGTERM");
  bool complete = true;
  for (auto& [name, service] : services) complete = service.stop() && complete;
  log_all_repeats();
  // Else a thread waits for a disk that does not answer, perhaps for ever.
  if (!complete) std::_Exit(1);
  return 0;
}

}  // namespace sweepd
