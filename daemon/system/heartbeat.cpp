#include "daemon/system/heartbeat.hpp"

#include <utility>

namespace sweepd {

std::vector<Heartbeat::Standstill> Heartbeat::look(const std::vector<Beats>& robots, Time now) {
  const bool was_away = now - looked_ > patience_;
  looked_ = now;
  std::vector<Standstill> still;
  std::map<std::string, Robot> seen;
  for (const Beats& beats : robots) {
    const auto known = robots_.find(beats.robot);
    const bool anew = was_away || known == robots_.end();
    Robot& robot = seen[beats.robot];
    if (!anew) robot = known->second;
    const auto judge = [&](const char* thread, Seen& before, std::uint64_t count) {
      if (anew || count != before.beats)
        before = {count, now};
      else if (now - before.since > patience_)
        still.push_back({beats.robot, thread, before.since});
    };
    judge("reply", robot.reply, beats.reply);
    judge("acquisition", robot.acquisition, beats.acquisition);
  }
  robots_ = std::move(seen);
  return still;
}

std::string text(const Heartbeat::Standstill& standstill, Heartbeat::Time now) {
  const auto time = std::chrono::duration_cast<std::chrono::seconds>(now - standstill.since);
  return standstill.robot + ": the " + standstill.thread + " thread has stood still for " +
         std::to_string(time.count()) + " s";
}

}  // namespace sweepd
