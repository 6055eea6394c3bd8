#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "rsi/capture/conversation.hpp"
#include "rsi/link/latency_histogram.hpp"
#include "rsi/link/link_report.hpp"

namespace sweepd {

// What is told of a link: link.json and link.txt, and the bins that both have of durations.

/// What every link_json() begins with.
[[nodiscard]] std::string link_json_begins();

/// The report on a link, schema sweepd.link/1. Units stand in the names; `at_s` is the time since
/// the first telegram. "replies" and "latency" are absent where no reply was seen, "cycle_ms" and
/// "jitter" before two telegrams came; what only the controller's Delay tells is null where it
/// sends none. Fields may be added.
[[nodiscard]] std::string link_json(const rsi::Conversation& conversation,
                                    const rsi::LinkReport& report);

/// The report on a link for a person in a terminal: the verdict with its reasons, then the figures,
/// lined up, with units, at most 80 columns.
[[nodiscard]] std::string link_text(const rsi::Conversation& conversation,
                                    const rsi::LinkReport& report);

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
