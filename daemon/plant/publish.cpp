#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

#include <sys/inotify.h>
#include <unistd.h>

#include "daemon/plant/broker_link.hpp"
#include "daemon/plant/daemon_state.hpp"
#include "daemon/plant/plant_services.hpp"
#include "daemon/plant/robot_publisher.hpp"
#include "daemon/record/session_folder.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/process_events.hpp"
#include "daemon/system/service_manager.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

constexpr auto kTurn = 200ms;
constexpr auto kAskEvery = 2s;
/// inotify does not see what comes over a network.
constexpr auto kLookEvery = 60s;

/// Says that something came into folders, by inotify. Where the system refuses to watch one, nobody
/// is told: who uses it looks now and then all the same. One thread.
class FolderWatch {
 public:
  FolderWatch() : notify_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {}
  ~FolderWatch() {
    if (notify_ >= 0) ::close(notify_);
  }
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  /// From now on, also; any number of times.
  void add(const std::filesystem::path& folder) {
    // The same folder has the same number.
    ::inotify_add_watch(notify_, folder.c_str(),
                        IN_CREATE | IN_MOVED_TO | IN_CLOSE_WRITE | IN_ONLYDIR);
  }
  /// Whether anything came since the last call. Does not wait.
  [[nodiscard]] bool changed() {
    bool any = false;
    alignas(inotify_event) char events[4096];
    while (::read(notify_, events, sizeof events) > 0) any = true;
    return any;
  }

 private:
  int notify_;
};

FolderLock held(const std::filesystem::path& spool) {
  make_spool(spool);
  FolderLock lock(spool);
  if (!lock.held())
    throw std::runtime_error(
        "the spool " + spool.string() +
        " cannot be held: another `sweepd publish` uses it, or it cannot be read; end that one, or "
        "give each its own `spool`");
  return lock;
}

std::vector<std::unique_ptr<RobotPublisher>> publishers(const Settings& settings,
                                                        const PublishOptions& options) {
  std::vector<std::unique_ptr<RobotPublisher>> robots;
  for (const RobotSettings& robot : settings.robots)
    robots.push_back(std::make_unique<RobotPublisher>(RobotPublisher::Options{
        {settings.publish->site.text, settings.publish->cell.text, robot.name},
        settings.publish->broker,
        settings.publish->spool,
        robot.output / robot.name,
        options.again}));
  return robots;
}

void ask(const Settings& settings, std::vector<std::unique_ptr<RobotPublisher>>& robots,
         Steady::time_point now) {
  const DaemonState state =
      settings.http.listen ? ask_daemon(*settings.http.listen)
                           : DaemonState{"the pages of sweepd are off (`listen` of [http])", {}};
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const auto told = state.robots.find(settings.robots[i].name);
    if (told != state.robots.end())
      robots[i]->hear(told->second, {}, now);
    else
      robots[i]->hear(
          {}, state.trouble.empty() ? "sweepd does not serve this robot" : state.trouble, now);
  }
}

}  // namespace

int publish_all(const PublishOptions& options) {
  const Settings settings = load_settings(options.config);
  if (!settings.publish)
    throw ConfigError(options.config.string() +
                      ": publish: expected a table, found nothing: add [publish] with `broker`, "
                      "`site` and `cell`");
  ProcessEvents events{SIGINT, SIGTERM, SIGHUP};
  const FolderLock lock = held(settings.publish->spool);
  auto robots = publishers(settings, options);
  Log().note("publishing {} as {}/{} to {}", rsi::counted(robots.size(), "robot", "robots"),
             settings.publish->site.text, settings.publish->cell.text,
             text(settings.publish->broker.address));

  FolderWatch watch;
  auto look_at = Steady::now(), ask_at = look_at;
  service_manager::ready();
  while (!is_ended(events)) {
    const auto now = Steady::now();
    const bool look = watch.changed() || now >= look_at;
    if (look) look_at = now + kLookEvery;
    if (now >= ask_at) {
      ask(settings, robots, now);
      ask_at = now + kAskEvery;
    }
    for (auto& robot : robots) {
      robot->turn(now, look);
      service_manager::beat();
      watch.add(robot->results());
      for (const auto& session : robot->watched()) watch.add(session);
    }
    log_repeats();
    events.wait_until(Steady::now() + kTurn);
  }
  service_manager::status("Ending");
  for (auto& robot : robots) robot->leave();
  log_all_repeats();
  return 0;
}

}  // namespace sweepd
