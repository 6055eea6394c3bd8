#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "rsi/endpoint.hpp"

namespace rsi {

/// How a telegram came in, judged by its IPOC.
enum class Arrival {
  in_order,
  duplicate,  ///< this IPOC was seen before
  reordered,  ///< older than the newest one, seen for the first time
  restart,    ///< the controller's RSI began anew: its IPOC or its port jumped
};

/// What happened to a controller's telegrams on the way. Counts since the first of them.
struct LinkCounts {
  std::uint64_t telegrams = 0;   ///< received with an IPOC, duplicates included
  std::uint64_t lost = 0;        ///< cycles between first and last of which no telegram came
  std::uint64_t duplicated = 0;  ///< telegrams that came again
  std::uint64_t reordered = 0;   ///< telegrams overtaken by a later one
  std::uint64_t restarts = 0;
  std::uint64_t late_replies = 0;  ///< replies that the controller missed in time, by its Delay
  std::uint64_t late_runs = 0;     ///< runs of consecutive late replies
  std::uint64_t longest_late_run = 0;
};

/// Link statistics of one controller, from IPOC, source and Delay of each telegram in order of
/// reception. The IPOC's step per cycle is learned: 4 or 12 (ms) on controllers, 1 on simulators;
/// that it passes 2^64 is nothing special. Constant memory; not thread-safe.
class LinkStatistics {
 public:
  /// `delay`: the telegram's <Delay D=>, where it has one.
  Arrival add(std::uint64_t ipoc, const Endpoint& source, std::optional<std::uint64_t> delay);

  [[nodiscard]] LinkCounts counts() const;

  /// IPOC's rise from one cycle to the next; nothing before two telegrams came in order.
  [[nodiscard]] std::optional<std::uint64_t> step() const;

 private:
  /// Telegrams between two restarts.
  struct Run {
    std::uint64_t oldest = 0;  ///< IPOC
    std::uint64_t newest = 0;
    std::uint64_t distinct = 0;
  };

  [[nodiscard]] std::uint64_t lost_in(const Run& run) const;
  [[nodiscard]] bool restarted(std::uint64_t ipoc, const Endpoint& source) const;
  [[nodiscard]] bool seen(std::uint64_t ipoc) const;
  void count_late(std::uint64_t ipoc, std::uint64_t delay);

  /// A telegram that is older than this, in IPOC's milliseconds, is no latecomer but a restart.
  static constexpr std::uint64_t kWindow = 4096;
  /// A rise by more than a minute is no loss but a restart.
  static constexpr std::uint64_t kLongestGap = 60'000;
  static constexpr std::size_t kLargestStep = 255;

  LinkCounts counts_;
  Run run_;
  Endpoint source_;
  std::uint64_t delay_ = 0;  // the last one, and its telegram
  std::uint64_t delay_ipoc_ = 0;
  std::array<std::uint64_t, kLargestStep + 1> steps_{};  // how often IPOC rose by so much
  std::uint64_t usual_step_ = 0;                         // the most frequent, of equals the least
  std::array<std::optional<std::uint64_t>, kWindow> recent_;  // at IPOC modulo the window
};

}  // namespace rsi
