#include "rsi/link/latency_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace rsi {
namespace {

constexpr int kBits = 7;  // a duration is known to this many leading bits
constexpr std::size_t kHalf = 1u << (kBits - 1);

std::size_t bucket_of(std::uint64_t value) {
  const int shift = std::max(0, static_cast<int>(std::bit_width(value)) - kBits);
  return static_cast<std::size_t>(shift) * kHalf + static_cast<std::size_t>(value >> shift);
}

std::int64_t middle_of(std::size_t bucket) {
  if (bucket < 2 * kHalf) return static_cast<std::int64_t>(bucket);
  const auto shift = bucket / kHalf - 1;
  const auto lowest = static_cast<std::int64_t>(kHalf + bucket % kHalf) << shift;
  return lowest + (std::int64_t{1} << shift >> 1);
}

}  // namespace

void LatencyHistogram::add(std::chrono::nanoseconds duration) noexcept {
  const std::int64_t value = std::max<std::int64_t>(0, duration.count());
  ++counts_[bucket_of(static_cast<std::uint64_t>(value))];
  ++count_;
  sum_ += std::min(value, std::numeric_limits<std::int64_t>::max() - sum_);
  max_ = std::max(max_, value);
}

std::chrono::nanoseconds LatencyHistogram::quantile(double q) const {
  const double share = std::ceil(std::clamp(q, 0.0, 1.0) * static_cast<double>(count_));
  const auto rank = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(share));
  if (rank >= count_) return max();
  std::uint64_t below = 0;
  std::size_t bucket = 0;
  while ((below += counts_[bucket]) < rank) ++bucket;
  return std::chrono::nanoseconds(std::min(middle_of(bucket), max_));
}

std::uint64_t LatencyHistogram::at_most(std::chrono::nanoseconds duration) const {
  return at_most(std::span(&duration, 1)).front();
}

std::vector<std::uint64_t> LatencyHistogram::at_most(
    std::span<const std::chrono::nanoseconds> durations) const {
  std::vector<std::uint64_t> counts;
  counts.reserve(durations.size());
  std::size_t bucket = 0;
  std::uint64_t below = 0;
  for (const auto duration : durations) {
    if (duration.count() >= 0)
      for (const auto last = bucket_of(static_cast<std::uint64_t>(duration.count()));
           bucket <= last; ++bucket)
        below += counts_[bucket];
    counts.push_back(below);
  }
  return counts;
}

}  // namespace rsi
