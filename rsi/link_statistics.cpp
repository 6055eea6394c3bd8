#include "rsi/link_statistics.hpp"

#include <algorithm>

namespace rsi {
namespace {

/// Whether `ipoc` was counted before `other`. By their difference, so that 0 follows the greatest
/// number.
bool older(std::uint64_t ipoc, std::uint64_t other) {
  return other - ipoc - 1 < std::uint64_t{1} << 63;
}

}  // namespace

Arrival LinkStatistics::add(std::uint64_t ipoc, const Endpoint& source,
                            std::optional<std::uint64_t> delay) {
  ++counts_.telegrams;
  Arrival arrival = Arrival::in_order;
  if (run_.distinct == 0 || restarted(ipoc, source)) {
    if (run_.distinct > 0) {
      arrival = Arrival::restart;
      ++counts_.restarts;
      counts_.lost += lost_in(run_);
    }
    run_ = {ipoc, ipoc, 0};
    recent_.fill({});
    delay_ = 0;
  } else if (seen(ipoc)) {
    ++counts_.duplicated;
    return Arrival::duplicate;
  } else if (older(ipoc, run_.newest)) {
    ++counts_.reordered;
    arrival = Arrival::reordered;
  } else if (ipoc - run_.newest <= kLargestStep) {
    const std::uint64_t step = ipoc - run_.newest;
    const std::uint64_t lead = steps_[usual_step_];
    if (++steps_[step] > lead || (steps_[step] == lead && step < usual_step_)) usual_step_ = step;
  }
  source_ = source;
  ++run_.distinct;
  if (older(ipoc, run_.oldest)) run_.oldest = ipoc;
  if (older(run_.newest, ipoc)) run_.newest = ipoc;
  recent_[ipoc % kWindow] = ipoc;
  if (delay && arrival != Arrival::reordered) count_late(ipoc, *delay);
  return arrival;
}

LinkCounts LinkStatistics::counts() const {
  LinkCounts counts = counts_;
  counts.lost += lost_in(run_);
  return counts;
}

std::optional<std::uint64_t> LinkStatistics::step() const {
  if (steps_[usual_step_] == 0) return std::nullopt;
  return usual_step_;
}

std::uint64_t LinkStatistics::lost_in(const Run& run) const {
  const auto step = this->step();
  if (!step || run.distinct == 0) return 0;
  const std::uint64_t cycles = (run.newest - run.oldest) / *step + 1;
  return cycles > run.distinct ? cycles - run.distinct : 0;
}

bool LinkStatistics::restarted(std::uint64_t ipoc, const Endpoint& source) const {
  if (!older(run_.newest, ipoc)) return run_.newest - ipoc >= kWindow || source != source_;
  const std::uint64_t rise = ipoc - run_.newest;
  return rise > kLongestGap || (source != source_ && rise != step());
}

bool LinkStatistics::seen(std::uint64_t ipoc) const {
  return recent_[ipoc % kWindow] == ipoc;
}

void LinkStatistics::count_late(std::uint64_t ipoc, std::uint64_t delay) {
  // Within a run of late replies Delay rises with each cycle. Where it rose by less it was 0 in
  // between, and a new run has begun.
  if (delay > 0) {
    const std::uint64_t cycles =
        std::max<std::uint64_t>(1, (ipoc - delay_ipoc_) / step().value_or(1));
    const bool goes_on = delay_ > 0 && delay >= delay_ + cycles;
    counts_.late_replies += goes_on ? delay - delay_ : delay;
    if (!goes_on) ++counts_.late_runs;
    counts_.longest_late_run = std::max(counts_.longest_late_run, delay);
  }
  delay_ = delay;
  delay_ipoc_ = ipoc;
}

}  // namespace rsi
