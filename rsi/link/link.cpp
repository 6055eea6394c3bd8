#include "rsi/link/link.hpp"

#include <algorithm>
#include <utility>

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

void add_run(const Place& run, WorstPlaces& runs) {
  if (run.amount > 0) runs.add(run);
}

}  // namespace

Fate fate(std::span<const Cycle> cycles, std::size_t index, std::chrono::nanoseconds cycle) {
  const Cycle& of = cycles[index];
  if (of.replied) return fate(*of.replied - of.received, std::nullopt, cycle);
  const auto later = cycles.subspan(index + 1);
  const auto next = std::find_if(later.begin(), later.end(),
                                 [](const Cycle& one) { return one.replied.has_value(); });
  if (next == later.end()) return Fate::unanswered;
  return fate(std::nullopt, *next->replied - of.received, cycle);
}

std::optional<Arrival> Link::telegram(const Datagram& datagram) {
  const Defect defect = telegram_.parse(datagram.payload);
  return telegram(datagram, telegram_, defect);
}

std::optional<Arrival> Link::telegram(const Datagram& datagram, const Telegram& telegram,
                                      Defect defect) {
  const bool malformed = defect != Defect::none || datagram.cut;
  const auto ipoc =
      defect == Defect::none ? telegram.ipoc() : ipoc_number(find_ipoc(datagram.payload));
  std::optional<std::uint64_t> delay;
  if (const Signal* const signal = delay_.in(telegram)) delay = ipoc_number(signal->text);
  if (malformed) ++report_.malformed;
  Arrival arrival = Arrival::in_order;
  if (ipoc) {
    Datagram whole = datagram;
    whole.cut = malformed;
    arrival = statistics_.add(whole, *ipoc, delay);
  } else {
    ++report_.unanswerable;
  }
  if (size_ == kMost) settle(kBatch, false);
  // Made in its place, number by number: all at once takes three times as long.
  Kept& cycle = cycles_[size_++];
  cycle.received = datagram.time;
  cycle.replied.reset();
  cycle.ipoc = ipoc;
  cycle.delay = delay;
  cycle.arrival = arrival;
  cycle.rise = 0;
  cycle.malformed = malformed;
  cycle.send_failed = false;
  cycle.since = {};
  cycle.begins_late_run = false;
  cycle.late_run = 0;
  if (!ipoc) return std::nullopt;
  if (!cycle.counts()) return arrival;
  if (newest_) {
    cycle.since = std::clamp(datagram.time - newest_->received, -kLongest, kLongest);
    if (arrival == Arrival::in_order) cycle.rise = *ipoc - newest_->ipoc;
  } else {
    report_.start = datagram.time;
  }
  if (early_reply_ && early_reply_->ipoc == ipoc && early_reply_->received >= datagram.time) {
    cycle.replied = early_reply_->received;
    if (newest_) --report_.replies.stray;
    early_reply_.reset();
  }
  if (arrival != Arrival::reordered) {
    const auto late_runs = statistics_.counts().late_runs;
    cycle.begins_late_run = late_runs != late_runs_;
    late_runs_ = late_runs;
    if (delay) cycle.late_run = static_cast<std::int64_t>(statistics_.late_run());
    newest_ = {datagram.time, *ipoc};
  }
  return arrival;
}

void Link::reply(const Datagram& datagram) {
  const auto begin =
      std::make_reverse_iterator(cycles_.begin() + static_cast<std::ptrdiff_t>(size_));
  const auto end = std::make_reverse_iterator(cycles_.begin());
  if (datagram.payload.empty()) {
    if (size_ > 0) begin->send_failed = true;
    ++report_.replies.failed;
    return;
  }
  ++report_.replies.sent;
  const auto ipoc = ipoc_number(find_ipoc(datagram.payload));
  if (!newest_) {  // the capture began between a telegram and its reply, or with an early one
    if (ipoc) early_reply_ = {datagram.time, *ipoc};
    return;
  }
  const auto found = std::find_if(
      begin, end, [&](const Kept& cycle) { return cycle.counts() && cycle.ipoc == ipoc; });
  if (found == end) {
    ++report_.replies.stray;
    if (ipoc) early_reply_ = {datagram.time, *ipoc};
  } else if (found->replied) {
    ++report_.replies.repeated;
  } else {
    found->replied = datagram.time;
  }
}

std::vector<Cycle> Link::last(std::size_t most) const {
  const std::size_t count = std::min({size_, kLast, most});
  const auto end = cycles_.begin() + static_cast<std::ptrdiff_t>(size_);
  return {end - static_cast<std::ptrdiff_t>(count), end};
}

LinkReport Link::report() const {
  Link end = *this;
  end.settle(end.size_, true);
  return end.settled();
}

Link::Reports Link::reports() const {
  Link end = *this;
  end.settle(size_ - std::min(size_, kUnsettled), false);
  const LinkReport settled = end.settled();
  end.settle(end.size_, true);
  return {end.settled(), settled};
}

LinkReport Link::settled() const {
  LinkReport report = report_;
  add_run(late_run_, report.late_runs);
  add_run(silent_run_, report.silent_runs);
  report.same_machine = statistics_.same_machine();
  report.link = statistics_.counts();
  report.step = statistics_.step();
  report.duration = settled_until_;
  report.cycle = cycle_;
  report.ipoc_counts_ms = unit_ == 1ms;
  if (report.replies.sent == 0 && report.replies.failed == 0) {
    report.replies = {};
    report.silent_runs = {};
  }
  return report;
}

void Link::settle(std::size_t count, bool at_end) {
  unit_ = statistics_.unit();
  cycle_ = statistics_.cycle().value_or(0ns);
  lay_out();
  for (std::size_t i = 0; i < count; ++i) {
    if (!cycles_[i].counts()) continue;
    score_arrival(cycles_[i]);
    score_late_run(cycles_[i]);
    score_reply(cycles_[i], at_end);
    if (cycles_[i].arrival != Arrival::reordered) settled_until_ = cycles_[i].at;
  }
  const auto rest = cycles_.begin() + static_cast<std::ptrdiff_t>(count);
  std::move(rest, cycles_.begin() + static_cast<std::ptrdiff_t>(size_), cycles_.begin());
  size_ -= count;
}

void Link::lay_out() {
  Nanoseconds before = settled_until_;
  for (std::size_t i = 0; i < size_; ++i) {
    Kept& cycle = cycles_[i];
    if (!cycle.counts()) continue;
    cycle.clock_stepped = clock_stepped(i);
    cycle.at = later(before, cycle.clock_stepped ? cycle.since - deviation(cycle) : cycle.since);
    if (cycle.arrival != Arrival::reordered) before = cycle.at;
  }
  bool step_follows = false;
  std::optional<Nanoseconds> next_reply;
  for (std::size_t i = size_; i-- > 0;) {
    Kept& cycle = cycles_[i];
    if (!cycle.counts()) continue;
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

bool Link::clock_stepped(std::size_t index) const {
  constexpr int kLeastCycles = 3;
  constexpr int kLookAhead = 2;
  const Kept& cycle = cycles_[index];
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

Link::Nanoseconds Link::deviation(const Kept& cycle) const {
  return cycle.since - static_cast<std::int64_t>(cycle.rise) * unit_;
}

void Link::score_arrival(const Kept& cycle) {
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
  const auto missing =
      static_cast<std::int64_t>(cycle.rise / statistics_.step_of_run().value_or(1)) - 1;
  if (missing > report_.longest_gap.amount) report_.longest_gap = {cycle.at, *cycle.ipoc, missing};
}

void Link::score_late_run(const Kept& cycle) {
  if (cycle.arrival == Arrival::reordered) return;
  if (cycle.begins_late_run || cycle.late_run == 0) end_run(late_run_, report_.late_runs);
  if (cycle.begins_late_run) late_run_ = {cycle.at, *cycle.ipoc, 0};
  late_run_.amount = std::max(late_run_.amount, cycle.late_run);
}

void Link::score_reply(const Kept& cycle, bool at_end) {
  if (cycle.arrival == Arrival::restart) end_run(silent_run_, report_.silent_runs);
  const Kept& last = *std::find_if(
      std::make_reverse_iterator(cycles_.begin() + static_cast<std::ptrdiff_t>(size_)),
      std::make_reverse_iterator(cycles_.begin()), [](const Kept& one) { return one.counts(); });
  if (at_end && !cycle.replied && !cycle.next_reply && last.at - cycle.at < cycle_) return;
  if (at_end && &cycle == &last && !cycle.replied) return;
  if (replied_in_time(cycle)) {
    end_run(silent_run_, report_.silent_runs);
  } else {
    if (silent_run_.amount == 0) silent_run_ = {cycle.at, *cycle.ipoc, 0};
    ++silent_run_.amount;
  }
}

bool Link::replied_in_time(const Kept& cycle) {
  ReplyCounts& counts = report_.replies;
  std::optional<Nanoseconds> to_reply, to_next_reply;
  if (cycle.replied) to_reply = cycle.timed ? *cycle.replied - cycle.received : 0ns;
  if (cycle.next_reply) to_next_reply = *cycle.next_reply - cycle.at;
  if (cycle.timed) {
    report_.latency.add(*to_reply);
    report_.slowest.add({cycle.at, *cycle.ipoc, to_reply->count()});
  } else if (cycle.replied) {
    ++counts.untimed;
  }
  const Fate became = fate(to_reply, to_next_reply, cycle_);
  ++(became == Fate::in_time      ? counts.in_time
     : became == Fate::late       ? counts.late
     : became == Fate::superseded ? counts.superseded
                                  : counts.unanswered);
  if (became == Fate::superseded)
    report_.longest_superseded = std::max(report_.longest_superseded, *to_next_reply);
  return became == Fate::in_time;
}

void Link::end_run(Place& run, WorstPlaces& runs) {
  add_run(run, runs);
  run = {};
}

}  // namespace rsi
