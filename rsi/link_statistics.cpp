#include "rsi/link_statistics.hpp"

#include <algorithm>

namespace rsi {

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
    recent_.fill(0);
    delay_ = 0;
  } else if (seen(ipoc)) {
    ++counts_.duplicated;
    return Arrival::duplicate;
  } else if (ipoc < run_.highest) {
    ++counts_.reordered;
    arrival = Arrival::reordered;
  } else if (ipoc - run_.highest <= kLargestStep) {
    const std::uint64_t step = ipoc - run_.highest;
    const std::uint64_t lead = steps_[usual_step_];
    if (++steps_[step] > lead || (steps_[step] == lead && step < usual_step_)) usual_step_ = step;
  }
  source_ = source;
  ++run_.distinct;
  run_.lowest = std::min(run_.lowest, ipoc);
  run_.highest = std::max(run_.highest, ipoc);
  recent_[ipoc % kWindow] = ipoc + 1;
  if (delay && arrival != Arrival::reordered) count_late(*delay);
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
  const std::uint64_t cycles = (run.highest - run.lowest) / *step + 1;
  return cycles > run.distinct ? cycles - run.distinct : 0;
}

bool LinkStatistics::restarted(std::uint64_t ipoc, const Endpoint& source) const {
  if (ipoc <= run_.highest) return run_.highest - ipoc >= kWindow || source != source_;
  const std::uint64_t rise = ipoc - run_.highest;
  return rise > kLongestGap || (source != source_ && rise != step());
}

bool LinkStatistics::seen(std::uint64_t ipoc) const {
  return recent_[ipoc % kWindow] == ipoc + 1;
}

void LinkStatistics::count_late(std::uint64_t delay) {
  // Delay counts up within a run of late replies; where it did not rise, a new run has begun.
  if (delay > 0) {
    const bool goes_on = delay_ > 0 && delay > delay_;
    counts_.late_replies += goes_on ? delay - delay_ : delay;
    if (!goes_on) ++counts_.late_runs;
    counts_.longest_late_run = std::max(counts_.longest_late_run, delay);
  }
  delay_ = delay;
}

}  // namespace rsi
