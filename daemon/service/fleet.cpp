#include "daemon/service/fleet.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "daemon/service/robot_threads.hpp"
#include "daemon/system/realtime.hpp"

namespace sweepd {

using Phase = RobotKeeper::Phase;

Fleet::Fleet(const Robots& robots, std::function<void()> on_change)
    : on_change_(std::move(on_change)), threads_(std::make_shared<RobotThreads>()) {
  for (const auto& robot : robots)
    robots_.emplace(robot.name, std::make_unique<RobotKeeper>(robot, threads_, on_change_));
}

void Fleet::serve() {
  for (const auto& [name, keeper] : robots_) keeper->serve();
}

void Fleet::reload(const Robots& robots) {
  std::set<std::string> names;
  for (const auto& robot : robots) names.insert(robot.name);
  for (auto robot = robots_.begin(); robot != robots_.end();) {
    if (names.contains(robot->first)) {
      ++robot;
      continue;
    }
    Log(robot->first).note("no longer in the settings: it is not served any more");
    robot->second->let_go();
    leaving_.push_back(std::move(robot->second));
    robot = robots_.erase(robot);
  }
  for (const auto& robot : robots) {
    if (const auto known = robots_.find(robot.name); known != robots_.end()) {
      known->second->reload(robot);
    } else {
      leave_processors(robot.real_time.cpus);
      const auto [came, is_new] =
          robots_.emplace(robot.name, std::make_unique<RobotKeeper>(robot, threads_, on_change_));
      came->second->serve();
    }
  }
}

void Fleet::report_link() {
  for (const auto& [name, keeper] : robots_) keeper->report_link();
}

void Fleet::let_all_go() {
  for (const auto& [name, keeper] : robots_) keeper->let_go();
}

bool Fleet::settled() const {
  return std::all_of(robots_.begin(), robots_.end(),
                     [](const auto& robot) { return robot.second->state().settled; });
}

std::optional<Problem> Fleet::mistake() const {
  for (const auto& [name, keeper] : robots_)
    if (const auto state = keeper->state(); state.phase == Phase::refused) return state.problem;
  return std::nullopt;
}

std::optional<Problem> Fleet::all_failed() const {
  std::optional<Problem> first;
  for (const auto& [name, keeper] : robots_) {
    const auto state = keeper->state();
    if (!state.problem) return std::nullopt;
    if (!first) first = state.problem;
  }
  return first;
}

std::vector<Heartbeat::Beats> Fleet::beats() const {
  std::vector<Heartbeat::Beats> all;
  for (const auto& [name, keeper] : robots_)
    if (const auto state = keeper->state(); state.beats) all.push_back(*state.beats);
  return all;
}

void Fleet::tell(ServiceStatus& status) const {
  for (const auto& [name, keeper] : robots_) {
    const auto state = keeper->state();
    if (state.status)
      status.robots.push_back(state.status);
    else
      status.not_served.push_back(
          {name, state.problem ? state.problem->text : "it is being tried for the first time"});
  }
}

bool Fleet::all(bool (RobotKeeper::*is)() const) const {
  return std::all_of(leaving_.begin(), leaving_.end(),
                     [&](const auto& keeper) { return (keeper.get()->*is)(); }) &&
         std::all_of(robots_.begin(), robots_.end(),
                     [&](const auto& robot) { return (robot.second.get()->*is)(); });
}

void Fleet::tidy() {
  std::erase_if(leaving_, [](const auto& keeper) { return keeper->finished(); });
}

}  // namespace sweepd
