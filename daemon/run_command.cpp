#include "daemon/run_command.hpp"

#include <csignal>
#include <cstdlib>
#include <map>
#include <memory>
#include <set>
#include <string>

#include <spdlog/fmt/ranges.h>

#include "daemon/config_error.hpp"
#include "daemon/heartbeat.hpp"
#include "daemon/http_pages.hpp"
#include "daemon/http_server.hpp"
#include "daemon/log.hpp"
#include "daemon/realtime.hpp"
#include "daemon/robot_service.hpp"
#include "daemon/service_manager.hpp"
#include "daemon/service_status.hpp"
#include "daemon/settings.hpp"
#include "daemon/status_line.hpp"

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
void reload(const RunOptions& options, const HttpSettings& http, Services& services) {
  const Log log;
  log.note("reading {} again", options.config.string());
  service_manager::reloading();
  try {
    const Settings settings = read_settings(options);
    std::set<std::string> names;
    for (const RobotSettings& robot : settings.robots) names.insert(robot.name);
    if (const auto keys = change(http, settings.http); !keys.empty())
      log.warning("only a restart of sweepd takes over {}", fmt::join(keys, ", "));
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
  explicit Watch(Published<ServiceStatus>& status) : status_(status) {}

  void look(const Services& services) {
    log_repeats();
    std::vector<Heartbeat::Beats> beats;
    for (const auto& [name, service] : services) beats.push_back(service.beats());
    const auto now = std::chrono::steady_clock::now();
    const auto still = heartbeat_.look(beats, now);
    for (const auto& [robot, thread, since] : still)
      Log(robot).error("the {} thread stands still: {}; see what holds up this machine", thread,
                       thread == "reply" ? "the robot gets no answers"
                                         : "the robot is answered, but nothing is recorded");
    if (still.empty()) service_manager::beat();

    ServiceStatus status{ServiceStatus::Phase::serving, {}, {}, now};
    for (const auto& [name, service] : services) status.robots.push_back(service.status());
    for (const auto& standstill : still) status.standstills.push_back(text(standstill, now));
    // A line that is still true is not told again.
    if (const auto line = status_line(status); line != told_) service_manager::status(told_ = line);
    status_.publish(std::move(status));
  }
  void stopping() {
    ServiceStatus status = *status_.newest();
    status.phase = ServiceStatus::Phase::stopping;
    status_.publish(std::move(status));
  }

 private:
  Published<ServiceStatus>& status_;
  Heartbeat heartbeat_;
  std::string told_;
};

/// Null if there are to be none, or cannot be: that is no reason not to serve robots.
std::unique_ptr<HttpServer> serve(const HttpPages& pages, const HttpSettings& settings) {
  if (!settings.listen) return nullptr;
  try {
    auto server = std::make_unique<HttpServer>(
        *settings.listen, [&](const HttpRequest& request) { return pages.answer(request); });
    Log().note("pages on http://{}/", rsi::text(server->local()));
    return server;
  } catch (const std::exception& error) {
    Log().error("{}; robots are served without them", error.what());
    return nullptr;
  }
}

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
  log_in_background();
  Services services;
  for (const RobotSettings& robot : settings.robots) services.try_emplace(robot.name, robot);
  Published<ServiceStatus> status;
  const HttpPages pages(status, settings.http);
  const auto http = serve(pages, settings.http);
  for (auto& [name, service] : services) service.start();

  service_manager::ready();
  Watch watch(status);
  constexpr timespec kOften{.tv_sec = 1, .tv_nsec = 0};
  int signal = 0;
  while (signal != SIGINT && signal != SIGTERM) {
    watch.look(services);
    signal = sigtimedwait(&signals, nullptr, &kOften);  // -1: none came
    if (signal == SIGHUP) reload(options, settings.http, services);
    if (signal == SIGUSR1)
      for (auto& [name, service] : services) service.report_link();
  }
  service_manager::stopping();
  watch.stopping();
  Log().note("ending on {}", signal == SIGINT ? "SIGINT" : "SIGTERM");
  bool complete = true;
  for (auto& [name, service] : services) complete = service.stop() && complete;
  log_all_repeats();
  // Else a thread waits for a disk or a reader that does not answer, perhaps for ever.
  const bool told = finish_log();
  if (!complete || !told) std::_Exit(complete ? 0 : 1);
  return 0;
}

}  // namespace sweepd
