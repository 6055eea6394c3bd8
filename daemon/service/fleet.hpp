#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/robot_keeper.hpp"
#include "daemon/service/service_status.hpp"

namespace sweepd {

/// All robots of the settings, served or not yet. Nothing waits here: what takes its time is done
/// by the keepers. One thread.
class Fleet {
 public:
  using Robots = std::vector<RobotSettings>;

  /// Tries each robot; serve() lets those be answered that can be. `on_change` is called by any
  /// thread when what is said of the robots here may have changed, and must not call this.
  explicit Fleet(
      const Robots& robots, std::function<void()> on_change = [] {});

  void serve();
  /// Robots that went are let go, those that came are served, the others take over what they can.
  void reload(const Robots& robots);
  void report_link();
  void let_all_go();

  /// Of all robots: what was asked for is done, or being tried again.
  [[nodiscard]] bool settled() const;
  /// A robot's files hold one.
  [[nodiscard]] std::optional<Problem> mistake() const;
  /// The first one, if no robot at all can be served.
  [[nodiscard]] std::optional<Problem> all_failed() const;

  /// Of those that are served.
  [[nodiscard]] std::vector<Heartbeat::Beats> beats() const;
  /// Fills in the robots, served and not.
  void tell(ServiceStatus& status) const;

  /// After let_all_go(): see RobotKeeper.
  [[nodiscard]] bool gone() const { return all(&RobotKeeper::gone); }
  [[nodiscard]] bool complete() const { return all(&RobotKeeper::complete); }
  [[nodiscard]] bool finished() const { return all(&RobotKeeper::finished); }
  /// Forgets those that have ended.
  void tidy();

 private:
  [[nodiscard]] bool all(bool (RobotKeeper::*is)() const) const;

  const std::function<void()> on_change_;
  const std::shared_ptr<RobotThreads> threads_;
  std::map<std::string, std::unique_ptr<RobotKeeper>> robots_;
  std::vector<std::unique_ptr<RobotKeeper>> leaving_;
};

}  // namespace sweepd
