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

double SampleClock::seconds(std::uint64_t ipoc, rsi::Timestamp received,
                            std::optional<std::uint64_t> step, bool restarted) {
  if (!started_ || restarted) {
    if (started_)
      run_start_s_ = std::max(latest_s_ + kPause_s, seconds_between(first_received_, received));
    else
      first_received_ = received;
    started_ = true;
    run_ipoc_ = ipoc;
    run_received_ = received;
  }
  const auto counts = static_cast<std::int64_t>(ipoc - run_ipoc_);  // latecomers: negative
  const double since =
      step == 1 ? seconds_between(run_received_, received) : static_cast<double>(counts) / 1000;
  const double time = run_start_s_ + since;
  latest_s_ = std::max(latest_s_, time);
  return time;
}

}  // namespace sweepd
