#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

namespace rsi {

/// Counts durations in buckets whose width grows with the duration: 64 to each power of two, so
/// that a quantile is off by at most 1/128 of itself. 30 kB however many are added; adding neither
/// allocates nor throws.
class LatencyHistogram {
 public:
  /// A negative duration counts as zero.
  void add(std::chrono::nanoseconds duration) noexcept;

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Of all durations; the longest duration there is where it would be longer.
  [[nodiscard]] std::chrono::nanoseconds sum() const { return std::chrono::nanoseconds(sum_); }
  /// Exact. Zero if nothing was added.
  [[nodiscard]] std::chrono::nanoseconds max() const { return std::chrono::nanoseconds(max_); }
  /// The smallest duration that at least the share `q` (0 to 1) of all durations does not exceed.
  /// Zero if nothing was added.
  [[nodiscard]] std::chrono::nanoseconds quantile(double q) const;
  /// How many durations were not longer than `duration`; those in its own bucket count as such.
  [[nodiscard]] std::uint64_t at_most(std::chrono::nanoseconds duration) const;
  /// The same for many durations, which rise, at the cost of one.
  [[nodiscard]] std::vector<std::uint64_t> at_most(
      std::span<const std::chrono::nanoseconds> durations) const;

 private:
  // Below 128 ns every value has its own bucket; the 56 octaves above (up to 2^63) have 64 each.
  std::array<std::uint64_t, 128 + 56 * 64> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t sum_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace rsi
