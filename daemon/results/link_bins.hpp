#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "rsi/link/latency_histogram.hpp"

namespace sweepd {

/// How many durations were longer than `from` and not longer than `to`.
struct LinkBin {
  std::chrono::nanoseconds from{};
  std::chrono::nanoseconds to{};
  std::uint64_t count = 0;
};

/// A histogram in bins that end at 1, 2 and 5 times a power of ten, from 1 µs on: from the first to
/// the last that holds anything, as exact as the histogram's own buckets. The first begins at zero
/// if it is that of 1 µs. Empty if nothing was added.
[[nodiscard]] std::vector<LinkBin> link_bins(const rsi::LatencyHistogram& histogram);

}  // namespace sweepd
