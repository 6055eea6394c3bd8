#include "rsi/link/link_monitor.hpp"

#include <algorithm>

#include "rsi/telegram/ipoc.hpp"

namespace rsi {

using namespace std::chrono_literals;
namespace {

/// So much time never passes between two telegrams in order, or a telegram and its reply.
constexpr std::chrono::nanoseconds kTooLong = 1h;
/// Stamps in a capture can be anything from 1970 to 2262: within these limits sums do not overflow.
constexpr std::chrono::nanoseconds kYear = 8766h;
constexpr std::chrono::nanoseconds kLongest = 100 * kYear;

std::chrono::nanoseconds later(std::chrono::nanoseconds time, std::chrono::nanoseconds by) {
  return std::min(time, kLongest) + std::clamp(by, std::chrono::nanoseconds(0), kYear);
}

}  // namespace

void LinkMonitor::telegram(const Datagram& datagram) {
  const Defect defect = telegram_.parse(datagram.payload);
  telegram(datagram, telegram_, defect);
}

void LinkMonitor::telegram(const Datagram& datagram, const Telegram& telegram, Defect defect) {
  const auto ipoc =
      defect == Defect::none ? telegram.ipoc() : ipoc_number(find_ipoc(datagram.payload));
  if (defect != Defect::none || datagram.cut) ++report_.malformed;
  if (!ipoc) {
    ++report_.unanswerable;
    return;
  }
  std::optional<std::uint64_t> delay;
  if (const auto at = telegram.find("Delay", "D", delay_hint_)) {
    delay_hint_ = *at;
    delay = ipoc_number(telegram.signals()[*at].text);
  }
  Cycle cycle;
  cycle.ipoc = *ipoc;
  cycle.received = datagram.time;
  Datagram whole = datagram;
  whole.cut = datagram.cut || defect != Defect::none;
  cycle.arrival = link_.add(whole, *ipoc, delay);
  if (cycle.arrival == Arrival::duplicate) return;
  if (newest_) {
    cycle.since = std::clamp(datagram.time - newest_->received, -kLongest, kLongest);
    if (cycle.arrival == Arrival::in_order) cycle.rise = *ipoc - newest_->ipoc;
  } else {
    report_.start = datagram.time;
  }
  if (cycle.arrival != Arrival::reordered) {
    newest_ = cycle;
    cycle.delay = delay.value_or(0);
    const auto late_runs = link_.counts().late_runs;
    cycle.begins_late_run = late_runs != late_runs_;
    late_runs_ = late_runs;
  }
  if (size_ == kMost) settle(kBatch, false);
  cycles_[size_++] = cycle;
}

void LinkMonitor::reply(const Datagram& datagram) {
  ++report_.replies.sent;
  if (!newest_) return;  // the capture began between a telegram and its reply
  const auto ipoc = ipoc_number(find_ipoc(datagram.payload));
  const auto end = std::make_reverse_iterator(cycles_.begin());
  const auto found =
      std::find_if(std::make_reverse_iterator(cycles_.begin() + static_cast<std::ptrdiff_t>(size_)),
                   end, [&](const Cycle& cycle) { return cycle.ipoc == ipoc; });
  if (found == end)
    ++report_.replies.stray;
  else if (found->replied)
    ++report_.replies.repeated;
  else
    found->replied = datagram.time;
}

LinkReport LinkMonitor::report() const {
  LinkMonitor end = *this;
  end.settle(end.size_, true);
  end.end_run(end.late_run_, end.report_.late_runs);
  end.end_run(end.silent_run_, end.report_.silent_runs);
  LinkReport report = end.report_;
  report.same_machine = link_.same_machine();
  report.link = link_.counts();
  report.step = link_.step();
  report.duration = end.settled_until_;
  report.cycle = end.cycle_;
  report.ipoc_counts_ms = end.unit_ == 1ms;
  if (report.replies.sent == 0) {
    report.replies = {};
    report.silent_runs = {};
  }
  return report;
}

void LinkMonitor::settle(std::size_t count, bool at_end) {
  unit_ = link_.unit();
  cycle_ = link_.cycle().value_or(0ns);
  lay_out();
  for (std::size_t i = 0; i < count; ++i) {
    score_arrival(cycles_[i]);
    score_late_run(cycles_[i]);
    score_reply(cycles_[i], at_end);
    if (cycles_[i].arrival != Arrival::reordered) settled_until_ = cycles_[i].at;
  }
  const auto rest = cycles_.begin() + static_cast<std::ptrdiff_t>(count);
  std::move(rest, cycles_.begin() + static_cast<std::ptrdiff_t>(size_), cycles_.begin());
  size_ -= count;
}

void LinkMonitor::lay_out() {
  Nanoseconds before = settled_until_;
  for (std::size_t i = 0; i < size_; ++i) {
    Cycle& cycle = cycles_[i];
    cycle.clock_stepped = clock_stepped(i);
    cycle.at = later(before, cycle.clock_stepped ? cycle.since - deviation(cycle) : cycle.since);
    if (cycle.arrival != Arrival::reordered) before = cycle.at;
  }
  bool step_follows = false;
  std::optional<Nanoseconds> next_reply;
  for (std::size_t i = size_; i-- > 0;) {
    Cycle& cycle = cycles_[i];
    cycle.next_reply = next_reply;
    const auto latency = cycle.replied.value_or(cycle.received) - cycle.received;
    cycle.timed = cycle.replied && !step_follows && latency >= 0ns && latency < kTooLong;
    if (cycle.replied) {
      const auto left = cycle.at + (cycle.timed ? latency : 0ns);
      next_reply = next_reply ? std::min(*next_reply, left) : left;
    }
    if (cycle.arrival != Arrival::reordered) step_follows = cycle.clock_stepped;
  }
}

bool LinkMonitor::clock_stepped(std::size_t index) const {
  constexpr int kLeastCycles = 3;
  constexpr int kLookAhead = 2;
  const Cycle& cycle = cycles_[index];
  if (cycle.rise == 0) return false;
  if (cycle.since < 0ns || cycle.since >= kTooLong) return true;
  if (unit_ != 1ms || deviation(cycle) <= kLeastCycles * cycle_) return false;
  int followed = 0;
  Nanoseconds caught_up{};
  for (std::size_t i = index + 1; i < size_ && followed < kLookAhead; ++i) {
    if (cycles_[i].arrival == Arrival::restart) break;
    if (cycles_[i].rise == 0) continue;
    caught_up += deviation(cycles_[i]);
    ++followed;
  }
  return followed > 0 && caught_up > -cycle_ / 2;
}

LinkMonitor::Nanoseconds LinkMonitor::deviation(const Cycle& cycle) const {
  return cycle.since - static_cast<std::int64_t>(cycle.rise) * unit_;
}

void LinkMonitor::score_arrival(const Cycle& cycle) {
  if (cycle.rise == 0) return;
  const Nanoseconds deviation = this->deviation(cycle);
  if (cycle.clock_stepped) {
    ++report_.clock_steps;
    if (cycle.since < 0ns) ++report_.clock_steps_back;
    if (std::chrono::abs(deviation) > std::chrono::abs(report_.largest_clock_step))
      report_.largest_clock_step = deviation;
  } else {
    report_.jitter.add(std::chrono::abs(deviation));
    report_.earliest = std::min(report_.earliest, deviation);
    report_.latest = std::max(report_.latest, deviation);
  }
  const auto missing = static_cast<std::int64_t>(cycle.rise / link_.step().value_or(1)) - 1;
  if (missing > report_.longest_gap.amount) report_.longest_gap = {cycle.at, cycle.ipoc, missing};
}

void LinkMonitor::score_late_run(const Cycle& cycle) {
  if (cycle.arrival == Arrival::reordered) return;
  if (cycle.begins_late_run || cycle.delay == 0) end_run(late_run_, report_.late_runs);
  if (cycle.begins_late_run) late_run_ = {cycle.at, cycle.ipoc, 0};
  late_run_.amount = std::max(late_run_.amount, static_cast<std::int64_t>(cycle.delay));
}

void LinkMonitor::score_reply(const Cycle& cycle, bool at_end) {
  if (cycle.arrival == Arrival::restart) end_run(silent_run_, report_.silent_runs);
  const Cycle& last = cycles_[size_ - 1];
  if (at_end && !cycle.replied && !cycle.next_reply && last.at - cycle.at < cycle_) return;
  if (at_end && &cycle == &last && !cycle.replied) return;
  if (replied_in_time(cycle)) {
    end_run(silent_run_, report_.silent_runs);
  } else {
    if (silent_run_.amount == 0) silent_run_ = {cycle.at, cycle.ipoc, 0};
    ++silent_run_.amount;
  }
}

bool LinkMonitor::replied_in_time(const Cycle& cycle) {
  ReplyCounts& counts = report_.replies;
  if (!cycle.replied) {
    const bool soon = cycle.next_reply && *cycle.next_reply - cycle.at <= 2 * cycle_;
    ++(soon ? counts.superseded : counts.unanswered);
    return false;
  }
  if (!cycle.timed) {
    ++counts.untimed;
    ++counts.in_time;
    return true;
  }
  const Nanoseconds latency = *cycle.replied - cycle.received;
  report_.latency.add(latency);
  report_.slowest.add({cycle.at, cycle.ipoc, latency.count()});
  const bool late = cycle_ > 0ns && latency > cycle_;
  ++(late ? counts.late : counts.in_time);
  return !late;
}

void LinkMonitor::end_run(Place& run, WorstPlaces& runs) {
  if (run.amount > 0) runs.add(run);
  run = {};
}

}  // namespace rsi
