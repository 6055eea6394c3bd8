#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "daemon/system/log.hpp"

namespace sweepd {

/// Holds back warnings and errors that repeat another of the last minute, and counts them; a note
/// tells of an event, each of which is news. Bounded. One thread.
class LogRepeats {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Whether this line is to be said now.
  [[nodiscard]] bool is_new(const LogLine& line, Time now);

  /// One line for each that was held back, with how often, whose minute is over at `now`.
  [[nodiscard]] std::vector<LogLine> due(Time now);
  /// The same, whether or not it is over.
  [[nodiscard]] std::vector<LogLine> all();

 private:
  static constexpr std::chrono::minutes kWindow{1};
  static constexpr std::size_t kMost = 1000;

  struct Said {
    Time at;
    std::uint64_t held_back = 0;
    LogLine newest;
  };
  using Key = std::pair<std::string, std::string>;  // robot, text

  std::map<Key, Said> said_;
};

}  // namespace sweepd
