#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace sweepd {

/// Judges whether the threads that serve the robots move, from what counts up while they do. It has
/// to look regularly: at least twice in the time for which a thread may stand still. One thread;
/// whoever needs the judgement has a Heartbeat of its own, so that nobody waits for another.
class Heartbeat {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Of one robot at one moment. Each rises several times a second while its thread does its work.
  struct Beats {
    std::string robot;  ///< unique
    std::uint64_t reply = 0;
    std::uint64_t acquisition = 0;
  };
  struct Standstill {
    std::string robot;
    std::string thread;  ///< "reply" or "acquisition"
    Time since;          ///< when it was first seen where it still is
  };

  explicit Heartbeat(std::chrono::milliseconds patience = std::chrono::seconds(3))
      : patience_(patience) {}

  /// The threads that have stood still for longer than `patience`, at `now`; none: all is well.
  /// Robots may come and go. Where nobody looked for longer than `patience`, perhaps because the
  /// whole machine was stopped, the threads get that time anew.
  [[nodiscard]] std::vector<Standstill> look(const std::vector<Beats>& robots, Time now);

 private:
  struct Seen {
    std::uint64_t beats = 0;
    Time since;
  };
  struct Robot {
    Seen reply, acquisition;
  };

  std::chrono::milliseconds patience_;
  std::map<std::string, Robot> robots_;
  Time looked_;
};

/// "kr5-arc: the reply thread has stood still for 5 s".
[[nodiscard]] std::string text(const Heartbeat::Standstill& standstill, Heartbeat::Time now);

}  // namespace sweepd
