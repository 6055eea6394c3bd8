#include "daemon/results/link_bins.hpp"

namespace sweepd {
namespace {

using std::chrono::nanoseconds;

/// The next of 1, 2, 5, 10, 20, 50, …; the longest duration where a number would be too large.
nanoseconds next_limit(nanoseconds limit, int index) {
  if (limit > nanoseconds::max() / 5) return nanoseconds::max();
  return index % 3 == 1 ? limit * 5 / 2 : limit * 2;
}

}  // namespace

std::vector<LinkBin> link_bins(const rsi::LatencyHistogram& histogram) {
  std::vector<LinkBin> bins;
  std::uint64_t below = 0;
  nanoseconds from{};
  nanoseconds to = std::chrono::microseconds(1);
  for (int index = 0; below < histogram.count(); ++index) {
    const auto until = histogram.at_most(to);
    if (until > 0) bins.push_back({from, to, until - below});
    below = until;
    from = to;
    to = next_limit(to, index);
  }
  return bins;
}

}  // namespace sweepd
