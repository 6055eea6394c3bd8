#include "daemon/results/link_totals.hpp"

#include <algorithm>

namespace sweepd {

void DurationCounts::add(const rsi::LatencyHistogram& histogram) {
  const auto more = histogram.at_most(limits);
  for (std::size_t i = 0; i < more.size(); ++i) at_most[i] += more[i];
  count += histogram.count();
  sum += histogram.sum();
}

void DurationCounts::never_less(const DurationCounts& before) {
  for (std::size_t i = 0; i < at_most.size(); ++i)
    at_most[i] = std::max(at_most[i], before.at_most[i]);
  count = std::max(count, before.count);
  sum = std::max(sum, before.sum);
}

double DurationCounts::mean_s() const {
  if (count == 0) return 0;
  return std::chrono::duration<double>(sum).count() / static_cast<double>(count);
}

void LinkTotals::add(const rsi::LinkReport& report) {
  telegrams += report.link.telegrams;
  lost += report.link.lost;
  duplicated += report.link.duplicated;
  reordered += report.link.reordered;
  malformed += report.malformed;
  restarts += report.link.restarts;
  if (const auto missed = report.link.late_replies)
    missed_by_controller = missed_by_controller.value_or(0) + *missed;
  in_time += report.replies.in_time;
  late += report.replies.late;
  superseded += report.replies.superseded;
  unanswered += report.replies.unanswered;
  clock_steps += report.clock_steps;
  latency.add(report.latency);
  jitter.add(report.jitter);
}

void LinkTotals::never_less(const LinkTotals& before) {
  for (const auto count :
       {&LinkTotals::telegrams, &LinkTotals::lost, &LinkTotals::duplicated, &LinkTotals::reordered,
        &LinkTotals::malformed, &LinkTotals::restarts, &LinkTotals::in_time, &LinkTotals::late,
        &LinkTotals::superseded, &LinkTotals::unanswered, &LinkTotals::clock_steps})
    this->*count = std::max(this->*count, before.*count);
  missed_by_controller = std::max(missed_by_controller, before.missed_by_controller);
  latency.never_less(before.latency);
  jitter.never_less(before.jitter);
}

}  // namespace sweepd
