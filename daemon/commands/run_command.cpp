#include "daemon/commands/run_command.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <future>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <spdlog/fmt/ranges.h>

#include "daemon/page/http_pages.hpp"
#include "daemon/page/http_server.hpp"
#include "daemon/service/fleet.hpp"
#include "daemon/service/service_status.hpp"
#include "daemon/service/status_line.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/heartbeat.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/realtime.hpp"
#include "daemon/system/service_manager.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;

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

/// Settings that are read while others wait for nothing: a disk may not answer.
class Reading {
 public:
  void begin(const RunOptions& options) {
    Log().note("reading {} again", options.config.string());
    service_manager::reloading();
    std::packaged_task<Settings()> task([options] { return read_settings(options); });
    settings_ = task.get_future();
    std::thread(std::move(task)).detach();
  }
  [[nodiscard]] bool under_way() const { return settings_.valid(); }
  [[nodiscard]] bool done() const {
    return under_way() && settings_.wait_for(0s) == std::future_status::ready;
  }
  /// A file with a mistake changes nothing.
  void take_over(const HttpSettings& http, Fleet& fleet) {
    try {
      const Settings settings = settings_.get();
      if (const auto keys = change(http, settings.http).after_restart; !keys.empty())
        Log().warning("only a restart of sweepd takes over {}", fmt::join(keys, ", "));
      fleet.reload(settings.robots);
    } catch (const std::exception& error) {
      Log().error("{}; sweepd goes on with the settings that it had", error.what());
    }
  }

 private:
  std::future<Settings> settings_;
};

/// Looks after the robots now and then: systemd hears that they are alive only while they are.
class Watch {
 public:
  explicit Watch(Published<ServiceStatus>& status) : status_(status) {}

  void look(const Fleet& fleet) {
    log_repeats();
    const auto now = std::chrono::steady_clock::now();
    const auto still = heartbeat_.look(fleet.beats(), now);
    for (const auto& [robot, thread, since] : still)
      Log(robot).error("the {} thread stands still: {}; see what holds up this machine", thread,
                       thread == "reply" ? "the robot gets no answers"
                                         : "the robot is answered, but nothing is recorded");
    if (still.empty()) service_manager::beat();

    ServiceStatus status{ServiceStatus::Phase::serving, {}, {}, now};
    fleet.tell(status);
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

/// What takes longer than this waits for a disk: nobody else does.
constexpr auto kPatience = 5s;
constexpr auto kOften = 1s;
constexpr auto kSoon = 20ms;

/// Waits until all robots have been tried.
void settle(const Fleet& fleet) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!fleet.settled() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(kSoon);
}

/// All that streams is completed, while systemd hears that sweepd is alive. Returns whether all of
/// it is.
bool end(Fleet& fleet) {
  fleet.let_all_go();
  for (auto due = std::chrono::steady_clock::now(); !fleet.gone();) {
    if (std::chrono::steady_clock::now() >= due) {
      service_manager::beat();
      due += kOften;
    }
    std::this_thread::sleep_for(kSoon);
  }
  return fleet.complete();
}

/// Waits for what the threads of the robots still hold; false if that takes too long.
bool finish(const Fleet& fleet) {
  const auto deadline = std::chrono::steady_clock::now() + 1s;
  while (!fleet.finished() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(kSoon);
  return fleet.finished();
}

/// Ends what has begun, and throws the problem; nothing happens if there is none.
void give_up(Fleet& fleet, const std::optional<Problem>& problem) {
  if (!problem) return;
  end(fleet);
  if (finish(fleet)) {
    if (problem->is_mistake) throw ConfigError(problem->text);
    throw std::runtime_error(problem->text);
  }
  Log().error("{}", problem->text);
  finish_log();
  std::_Exit(EXIT_FAILURE);
}

/// The next signal; -1 if none comes in time.
int next_signal(const sigset_t& signals, std::chrono::milliseconds time) {
  const auto ns = std::chrono::nanoseconds(time).count();
  const timespec longest{ns / 1'000'000'000, ns % 1'000'000'000};
  return sigtimedwait(&signals, nullptr, &longest);
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
  Published<ServiceStatus> status;
  const HttpPages pages(status, settings.http);
  Fleet fleet(settings.robots);
  settle(fleet);
  give_up(fleet, fleet.mistake());
  give_up(fleet, fleet.all_failed());
  const auto http = serve(pages, settings.http);
  fleet.serve();
  settle(fleet);
  give_up(fleet, fleet.all_failed());

  service_manager::ready();
  Watch watch(status);
  Reading reading;
  bool read_again = false;
  bool reloaded = false;  // and not told yet
  auto told_by = std::chrono::steady_clock::time_point::max();
  int signal = 0;
  while (signal != SIGINT && signal != SIGTERM) {
    watch.look(fleet);
    signal = next_signal(signals, reading.under_way() || reloaded ? kSoon : kOften);
    if (signal == SIGHUP) read_again = true;
    if (signal == SIGUSR1) fleet.report_link();
    if (read_again && !reading.under_way()) {
      read_again = false;
      reading.begin(options);
    }
    if (reading.done()) {
      reading.take_over(settings.http, fleet);
      reloaded = true;
      told_by = std::chrono::steady_clock::now() + kPatience;
    }
    if (reloaded && (fleet.settled() || std::chrono::steady_clock::now() > told_by)) {
      service_manager::ready();
      reloaded = false;
    }
    fleet.tidy();
  }
  service_manager::stopping();
  watch.stopping();
  Log().note("ending on {}", signal == SIGINT ? "SIGINT" : "SIGTERM");
  const bool complete = end(fleet);
  log_all_repeats();
  // Else a thread waits for a disk or a reader that does not answer, perhaps for ever.
  const bool told = finish_log();
  if (!finish(fleet) || reading.under_way() || !told) std::_Exit(complete ? 0 : 1);
  return complete ? 0 : 1;
}

}  // namespace sweepd
