#include "daemon/commands/run_command.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/ranges.h>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/page/http_pages.hpp"
#include "daemon/page/http_server.hpp"
#include "daemon/service/fleet.hpp"
#include "daemon/service/service_status.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/heartbeat.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/process_events.hpp"
#include "daemon/system/process_state.hpp"
#include "daemon/system/realtime.hpp"
#include "daemon/system/service_manager.hpp"
#include "daemon/text/text_layout.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

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

/// What came through a pipe at the start comes no second time: to wait for it keeps SIGHUP waiting.
void refuse_pipe(const std::filesystem::path& config) {
  std::error_code error;
  if (std::filesystem::is_fifo(config, error))
    throw ConfigError(config.string() +
                      ": expected a file, found a pipe, which cannot be read again: put a file in "
                      "its place, or restart sweepd");
}

/// Settings that are read while others wait for nothing: a disk may not answer.
class Reading {
 public:
  Reading() = default;
  ~Reading() {
    if (thread_.joinable()) thread_.detach();
  }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

  void begin(const std::function<Settings()>& read, ProcessEvents& events) {
    log_all_repeats();  // what is wrong with the settings now is news
    Log().note("reading the settings again");
    service_manager::reloading();
    std::packaged_task<Settings()> task(read);
    auto settings = task.get_future();
    try {
      thread_ = std::thread([task = std::move(task), &events]() mutable {
        task();
        events.wake();
      });
      settings_ = std::move(settings);
    } catch (const std::system_error& error) {
      Log().error(
          "the settings cannot be read again ({}); sweepd goes on with the settings that "
          "it had: send SIGHUP once more",
          error.code().message());
      service_manager::ready();
    }
  }
  [[nodiscard]] bool under_way() const { return settings_.valid(); }
  [[nodiscard]] bool done() const {
    return under_way() && settings_.wait_for(0s) == std::future_status::ready;
  }
  /// A file with a mistake changes nothing.
  void take_over(const Settings& now, Fleet& fleet) {
    thread_.join();
    const std::string file = now.file.empty() ? "the settings" : now.file.string();
    std::optional<Settings> settings;
    try {
      settings = settings_.get();
    } catch (const std::exception& error) {
      for (const auto& line : lines_of(error.what())) Log().error("{}", line);
      Log().error(
          "nothing of {} is taken over; sweepd goes on with the settings that it had: correct the "
          "file and send SIGHUP once more",
          file);
      return;
    }
    if (const auto keys = change(now.http, settings->http).of(TakesEffect::after_restart);
        !keys.empty())
      Log().warning("only a restart of sweepd takes over {}", fmt::join(keys, ", "));
    try {
      fleet.reload(settings->robots);
    } catch (const std::exception& error) {
      Log().error("{}; only a part of {} may be taken over: send SIGHUP once more", error.what(),
                  file);
    }
  }

 private:
  std::future<Settings> settings_;
  std::thread thread_;
};

/// Looks after the robots now and then: systemd hears that they are alive only while they are.
class Watch {
 public:
  explicit Watch(Published<ServiceStatus>& status) : status_(status) {}

  void look(const Fleet& fleet) {
    log_repeats();
    const auto now = Steady::now();
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

/// The pages, as soon as their port can be had: that it cannot is no reason not to serve robots.
class PageServer {
 public:
  PageServer(const HttpPages& pages, const HttpSettings& settings)
      : pages_(pages), settings_(settings) {}

  /// Tries, unless that was done a moment ago.
  void serve() {
    constexpr auto kAgain = 5s;
    if (!settings_.listen || server_ || Steady::now() < next_) return;
    try {
      server_ = std::make_unique<HttpServer>(
          *settings_.listen, [this](const HttpRequest& request) { return pages_.answer(request); });
      Log().note("pages on http://{}/", rsi::text(server_->local()));
    } catch (const std::exception& error) {
      next_ = Steady::now() + kAgain;
      if (error.what() == said_) return;
      said_ = error.what();
      Log().error("{}; robots are served without them, and it is tried again every few seconds",
                  said_);
    }
  }

 private:
  const HttpPages& pages_;
  const HttpSettings settings_;
  std::unique_ptr<HttpServer> server_;
  Steady::time_point next_{};
  std::string said_;
};

/// What takes longer than this waits for a disk: nobody else does.
constexpr auto kPatience = 5s;
constexpr auto kOften = 1s;

/// Waits until all robots have been tried.
void settle(const Fleet& fleet, ProcessEvents& events) {
  events.wait_until(Steady::now() + kPatience, [&] { return fleet.settled(); });
}

/// All that streams is completed, while systemd hears that sweepd is alive. Returns whether all of
/// it is.
bool end(Fleet& fleet, ProcessEvents& events) {
  fleet.let_all_go();
  do service_manager::beat();
  while (!events.wait_until(Steady::now() + kOften, [&] { return fleet.gone(); }));
  return fleet.complete();
}

/// Waits for what the threads of the robots still hold; false if that takes too long.
bool finish(const Fleet& fleet, ProcessEvents& events) {
  return events.wait_until(Steady::now() + 1s, [&] { return fleet.finished(); });
}

/// Ends what has begun, and throws the problem; nothing happens if there is none.
void give_up(Fleet& fleet, ProcessEvents& events, const std::optional<Problem>& problem) {
  if (!problem) return;
  end(fleet, events);
  if (finish(fleet, events)) {
    if (problem->is_mistake) throw ConfigError(problem->text);
    throw std::runtime_error(problem->text);
  }
  Log().error("{}", problem->text);
  finish_log();
  std::_Exit(EXIT_FAILURE);
}

}  // namespace

int run(const RunOptions& options) {
  return serve_robots([options, again = false]() mutable {
    if (std::exchange(again, true)) refuse_pipe(options.config);
    return read_settings(options);
  });
}

int serve_robots(const std::function<Settings()>& read) {
  const Settings settings = read();
  ProcessEvents events{SIGINT, SIGTERM, SIGHUP, SIGUSR1};
  allow_open_files();

  // What all other threads inherit: each reply thread chooses its own.
  for (const RobotSettings& robot : settings.robots) leave_processors(robot.real_time.cpus);
  log_in_background();
  Published<ServiceStatus> status;
  const HttpPages pages(status, settings.http);
  Fleet fleet(settings.robots, [&events] { events.wake(); });
  settle(fleet, events);
  give_up(fleet, events, fleet.mistake());
  give_up(fleet, events, fleet.all_failed());
  PageServer page_server(pages, settings.http);
  page_server.serve();
  fleet.serve();
  settle(fleet, events);
  give_up(fleet, events, fleet.all_failed());

  service_manager::ready();
  Watch watch(status);
  Reading reading;
  bool read_again = false;
  auto told_by = Steady::time_point::max();  // earlier: reloaded, and not told yet
  std::optional<int> ending;
  while (!ending) {
    watch.look(fleet);
    page_server.serve();
    events.wait_until(std::min(Steady::now() + kOften, told_by));
    while (const auto signal = events.next_signal()) {
      if (*signal == SIGHUP)
        read_again = true;
      else if (*signal == SIGUSR1)
        fleet.report_link();
      else
        ending = signal;
    }
    if (reading.done()) {
      reading.take_over(settings, fleet);
      told_by = Steady::now() + kPatience;
    }
    if (told_by != Steady::time_point::max() && (fleet.settled() || Steady::now() >= told_by)) {
      service_manager::ready();
      told_by = Steady::time_point::max();
    }
    if (read_again && !reading.under_way()) {
      read_again = false;
      reading.begin(read, events);
    }
    fleet.tidy();
  }
  service_manager::stopping();
  watch.stopping();
  Log().note("ending on {}", ending == SIGINT ? "SIGINT" : "SIGTERM");
  const bool complete = end(fleet, events);
  log_all_repeats();
  // Else a thread waits for a disk or a reader that does not answer, perhaps for ever.
  const bool told = finish_log();
  if (!finish(fleet, events) || reading.under_way() || !told) std::_Exit(complete ? 0 : 1);
  return complete ? 0 : 1;
}

CLI::App* add_run(CLI::App& app, RunOptions& options) {
  auto* command = app.add_subcommand(
      "run",
      "Serve robot controllers: answer and record their RSI telegrams, identify the robots\n"
      "The command stays in the foreground until SIGTERM or SIGINT. SIGHUP makes it read the "
      "settings again.");
  command->add_option("--config", options.config, "Read the settings from this file")
      ->capture_default_str()
      ->type_name("FILE");
  command->add_option("--output", options.output, "Keep recordings and results below this folder")
      ->type_name("DIR")
      ->default_str("the `output` of each robot's settings");
  command
      ->add_option("--listen", parsed(options.listen, rsi::parse_endpoint, "--listen", kAnEndpoint),
                   "Receive telegrams on this IPv4 address and port, where the settings have one "
                   "robot")
      ->type_name("ADDRESS:PORT")
      ->default_str("the `listen` of the robot's settings");
  command->add_flag_callback(
      "--help-settings",
      [] {
        std::cout << settings_text();
        throw CLI::Success();
      },
      "Print every key of the settings file with its meaning and default, and exit");
  command->footer(exit_status({kOk, kError, kWrongUsage, kWrongFile}));
  return command;
}

}  // namespace sweepd
