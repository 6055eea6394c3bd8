#include "daemon/stream/sample_clock.hpp"

#include <algorithm>
#include <chrono>

namespace sweepd {
namespace {

constexpr double kPause_s = 0.5;

double seconds_between(rsi::Timestamp from, rsi::Timestamp to) {
  return std::chrono::duration<double>(to - from).count();
}

/// By their difference: IPOC passes over its greatest number.
double counts_between(std::uint64_t from, std::uint64_t to) {
  return static_cast<double>(static_cast<std::int64_t>(to - from));
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
    newest_ = since_;
  } else if (counts_ms != counts_ms_) {
    since_ = newest_;
  }
  started_ = true;
  counts_ms_ = counts_ms;
  const double behind = counts_between(ipoc, newest_.ipoc);
  const bool overtaken = behind > 0;
  double time = since_.seconds;
  if (counts_ms) {
    time += counts_between(since_.ipoc, ipoc) / 1000;
  } else if (overtaken) {
    const double all = counts_between(since_.ipoc, newest_.ipoc);
    time = newest_.seconds - (all > 0 ? behind * (newest_.seconds - since_.seconds) / all : 0);
  } else {
    time += seconds_between(since_.received, received);
  }
  if (!overtaken) newest_ = {time, ipoc, received};
  return time;
}

}  // namespace sweepd
