#include "rsi/link/last_cycles.hpp"

#include <algorithm>

#include "rsi/counted.hpp"

namespace rsi {
namespace {

using std::chrono::nanoseconds;

/// Exact, as a double is not: 1735689600.004000120.
std::string exact_seconds(nanoseconds time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::string rest = std::to_string(kSecond + time.count() % kSecond).substr(1);
  return std::to_string(time.count() / kSecond) + "." + rest;
}

/// With three decimals, exact.
std::string microseconds(nanoseconds time) {
  const auto size = std::chrono::abs(time).count();
  return (time.count() < 0 ? "-" : "") + std::to_string(size / 1000) + "." +
         std::to_string(1000 + size % 1000).substr(1);
}

std::string optional_number(const std::optional<std::uint64_t>& value) {
  return value ? std::to_string(*value) : std::string();
}

}  // namespace

LastCycles::LastCycles(const Link& link, bool expects_replies, std::uint64_t withheld)
    : cycles_(link.last()),
      expects_replies_(expects_replies),
      same_machine_(link.statistics().same_machine()),
      step_(link.statistics().step_of_run().value_or(0)),
      cycle_time_(link.statistics().cycle().value_or(nanoseconds(0))) {
  const std::uint64_t all = link.statistics().counts().telegrams;
  const std::uint64_t before = all - std::min<std::uint64_t>(all, cycles_.size());
  withheld_ = withheld - std::min(withheld, before);
}

std::string LastCycles::reason() const {
  std::array<std::uint64_t, kEvents> count{};
  std::uint64_t lost = 0;
  std::uint64_t overtaken = 0;  // these fill a gap that was taken for a loss
  std::uint64_t delay = 0;
  for (std::size_t i = 0; i < cycles_.size(); ++i) {
    ++count[static_cast<std::size_t>(event(i))];
    lost += i > 0 ? lost_before(cycles_[i]) : 0;
    if (cycles_[i].arrival == Arrival::reordered) ++overtaken;
    delay = std::max(delay, cycles_[i].delay.value_or(0));
  }
  const auto of = [&](Event event) { return count[static_cast<std::size_t>(event)]; };
  const auto sentence = [&](std::uint64_t number, const char* one, const char* many,
                            const char* rest) {
    return "in the last " + counted(cycles_.size(), "cycle") + " " + counted(number, one, many) +
           " " + rest;
  };
  if (of(Event::send_failed) > 0)
    return sentence(of(Event::send_failed), "reply", "replies",
                    "could not be sent: look at this machine's network");
  if (const auto missing = of(Event::unanswered) + of(Event::superseded); missing > 0)
    return sentence(missing, "telegram", "telegrams",
                    "got no reply: see what kept this machine busy");
  if (expects_replies_ && of(Event::malformed) > 0)
    return sentence(of(Event::malformed), "datagram was", "datagrams were",
                    "no whole telegram: see what else uses the controller's address and this port");
  if (of(Event::late) > 0)
    return sentence(of(Event::late), "reply", "replies",
                    "left later than a cycle: see what kept this machine busy");
  if (expects_replies_ && delay > 0)
    return sentence(delay, "reply", "replies in a row",
                    same_machine_
                        ? "came too late for the controller (Delay), though all left in time: see "
                          "what keeps it busy on this machine"
                        : "came too late for the controller (Delay), though all left in time: look "
                          "at the network to it");
  if (lost > overtaken)
    return sentence(lost - overtaken, "telegram", "telegrams",
                    same_machine_
                        ? "never came: see what kept the sender on this machine busy, and the "
                          "receive buffer"
                        : "never came: look at cable, switch and receive buffer");
  return {};
}

std::string LastCycles::csv() const {
  std::string text =
      "received_s,replied_s,ipoc,latency_us,delay_packets,lost_before_packets,event\n";
  for (std::size_t i = 0; i < cycles_.size(); ++i) {
    const Cycle& row = cycles_[i];
    text += exact_seconds(row.received) + ",";
    if (row.replied) text += exact_seconds(*row.replied);
    text += "," + optional_number(row.ipoc) + ",";
    if (row.replied) text += microseconds(*row.replied - row.received);
    text += "," + optional_number(row.delay) + "," + std::to_string(lost_before(row)) + ",";
    text.append(LastCycles::text(event(i))).append("\n");
  }
  return text;
}

std::string_view LastCycles::text(Event event) {
  constexpr std::array<std::string_view, kEvents> kTexts{"answered",   "late",        "superseded",
                                                         "unanswered", "send_failed", "received",
                                                         "duplicate",  "malformed",   "withheld"};
  return kTexts[static_cast<std::size_t>(event)];
}

LastCycles::Event LastCycles::event(std::size_t index) const {
  const Cycle& seen = cycles_[index];
  if (seen.send_failed) return Event::send_failed;
  if (seen.malformed) return Event::malformed;
  if (!seen.replied) {
    if (seen.arrival == Arrival::duplicate || seen.arrival == Arrival::completed)
      return Event::duplicate;
    if (!expects_replies_) return Event::received;
    if (index < withheld_) return Event::withheld;
  }
  const Fate became = fate(cycles_, index, cycle_time_);
  const bool waits =
      index + 1 == cycles_.size() || cycles_.back().received - seen.received < cycle_time_;
  if (became == Fate::unanswered && waits) return Event::received;
  constexpr std::array kOfFates{Event::answered, Event::late, Event::superseded, Event::unanswered};
  return kOfFates[static_cast<std::size_t>(became)];
}

std::uint64_t LastCycles::lost_before(const Cycle& cycle) const {
  return step_ > 0 && cycle.rise > step_ ? cycle.rise / step_ - 1 : 0;
}

}  // namespace rsi
