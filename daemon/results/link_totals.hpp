#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rsi/link/link_report.hpp"

namespace sweepd {

/// Durations counted by fixed limits, as Prometheus has its histograms: what two of them hold can
/// be added. A duration within a sixty-fourth of a limit may count as on its other side.
struct DurationCounts {
  std::span<const std::chrono::nanoseconds> limits;  ///< they rise; they outlive this
  std::vector<std::uint64_t> at_most;                ///< one a limit
  std::uint64_t count = 0;
  std::chrono::nanoseconds sum{};

  explicit DurationCounts(std::span<const std::chrono::nanoseconds> upper_limits)
      : limits(upper_limits), at_most(upper_limits.size()) {}

  void add(const rsi::LatencyHistogram& histogram);
  void never_less(const DurationCounts& before);
  [[nodiscard]] double mean_s() const;  ///< 0 if there are none
};

/// From a telegram to its reply: mostly tens of microseconds; a robot with a cycle of 4 or 12 ms
/// stops some cycles later.
inline constexpr std::array<std::chrono::nanoseconds, 17> kLatencyLimits{
    std::chrono::microseconds(10),  std::chrono::microseconds(25),  std::chrono::microseconds(50),
    std::chrono::microseconds(100), std::chrono::microseconds(250), std::chrono::microseconds(500),
    std::chrono::milliseconds(1),   std::chrono::milliseconds(2),   std::chrono::milliseconds(3),
    std::chrono::milliseconds(4),   std::chrono::milliseconds(6),   std::chrono::milliseconds(8),
    std::chrono::milliseconds(12),  std::chrono::milliseconds(24),  std::chrono::milliseconds(48),
    std::chrono::milliseconds(100), std::chrono::seconds(1)};

/// From the cycle's own time to the time between two telegrams, whichever is longer.
inline constexpr std::array<std::chrono::nanoseconds, 15> kJitterLimits{
    std::chrono::microseconds(10),  std::chrono::microseconds(25),  std::chrono::microseconds(50),
    std::chrono::microseconds(100), std::chrono::microseconds(250), std::chrono::microseconds(500),
    std::chrono::milliseconds(1),   std::chrono::milliseconds(2),   std::chrono::milliseconds(4),
    std::chrono::milliseconds(8),   std::chrono::milliseconds(12),  std::chrono::milliseconds(24),
    std::chrono::milliseconds(48),  std::chrono::milliseconds(100), std::chrono::seconds(1)};

/// What became of all telegrams of one robot, over its sessions.
struct LinkTotals {
  std::uint64_t telegrams = 0;  ///< with an IPOC, duplicates included
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;
  std::uint64_t malformed = 0;
  std::uint64_t restarts = 0;                         ///< of the controller's IPOC within a session
  std::optional<std::uint64_t> missed_by_controller;  ///< replies, by its Delay, if it sends one
  std::uint64_t in_time = 0;  ///< telegrams by their reply, see rsi::ReplyCounts
  std::uint64_t late = 0;
  std::uint64_t superseded = 0;
  std::uint64_t unanswered = 0;
  std::uint64_t clock_steps = 0;
  DurationCounts latency{kLatencyLimits};
  DurationCounts jitter{kJitterLimits};

  /// One session more, or as much of it as there is.
  void add(const rsi::LinkReport& report);
  /// A telegram that was taken for lost may still come, a reply too: what has been told of a
  /// session under way can turn out too high. A counter must not fall, so it waits.
  void never_less(const LinkTotals& before);
};

}  // namespace sweepd
