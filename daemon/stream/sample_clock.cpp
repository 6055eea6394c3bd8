#include "daemon/stream/sample_clock.hpp"

#include <algorithm>
#include <chrono>

namespace sweepd {
namespace {

constexpr double kPause_s = 0.5;

double seconds_between(rsi::Timestamp from, rsi::Timestamp to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

double SampleClock::seconds(std::uint64_t ipoc, rsi::Timestamp received, bool counts_ms,
                            bool restarted) {
  if (!started_) {
    first_received_ = received;
    since_ = newest_ = {0, ipoc, received};
  } else if (restarted) {
    since_ = {std::max(newest_.seconds + kPause_s, seconds_between(first_received_, received)),
              ipoc, received};
  } else if (counts_ms != counts_ms_) {
    since_ = newest_;
  }
  started_ = true;
  counts_ms_ = counts_ms;
  const auto counts = static_cast<std::int64_t>(ipoc - since_.ipoc);  // latecomers: negative
  const double time = since_.seconds + (counts_ms ? static_cast<double>(counts) / 1000
                                                  : seconds_between(since_.received, received));
  if (restarted || time >= newest_.seconds) newest_ = {time, ipoc, received};
  return time;
}

}  // namespace sweepd
