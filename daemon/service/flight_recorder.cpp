#include "daemon/service/flight_recorder.hpp"

#include <algorithm>

#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "rsi/counted.hpp"
#include "rsi/telegram/ipoc.hpp"

namespace sweepd {
namespace {

using std::chrono::nanoseconds;

/// Exact, as a double is not: 1735689600.004000120.
std::string exact_seconds(nanoseconds time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::string rest = std::to_string(kSecond + time.count() % kSecond).substr(1);
  return std::to_string(time.count() / kSecond) + "." + rest;
}

std::string optional_number(const std::optional<std::uint64_t>& value) {
  return value ? std::to_string(*value) : std::string();
}

}  // namespace

void FlightRecorder::telegram(const rsi::Datagram& datagram) {
  const auto defect = telegram_.parse(datagram.payload);
  telegram(datagram, telegram_, defect);
}

void FlightRecorder::telegram(const rsi::Datagram& datagram, const rsi::Telegram& telegram,
                              rsi::Defect defect) {
  Cycle cycle;
  cycle.received = datagram.time;
  cycle.malformed = defect != rsi::Defect::none || datagram.cut;
  cycle.ipoc = defect == rsi::Defect::none ? telegram.ipoc()
                                           : rsi::ipoc_number(rsi::find_ipoc(datagram.payload));
  if (const auto at = telegram.find("Delay", "D", delay_hint_)) {
    delay_hint_ = *at;
    cycle.delay = rsi::ipoc_number(telegram.signals()[*at].text);
  }
  if (cycle.ipoc) {
    rsi::Datagram whole = datagram;
    whole.cut = cycle.malformed;
    const auto arrival = link_.add(whole, *cycle.ipoc, cycle.delay);
    cycle.duplicate = arrival == rsi::Arrival::duplicate;
    cycle.reordered = arrival == rsi::Arrival::reordered;
    if (arrival == rsi::Arrival::in_order && newest_ipoc_) cycle.rise = *cycle.ipoc - *newest_ipoc_;
    if (arrival == rsi::Arrival::in_order || arrival == rsi::Arrival::restart)
      newest_ipoc_ = cycle.ipoc;
  }
  cycles_[next_] = cycle;
  next_ = (next_ + 1) % kCycles;
  size_ = std::min(size_ + 1, kCycles);
}

void FlightRecorder::reply(const rsi::Datagram& datagram) {
  const auto ipoc = rsi::ipoc_number(rsi::find_ipoc(datagram.payload));
  if (!ipoc) return;
  for (std::size_t back = 0; back < size_; ++back) {
    Cycle& cycle = newest(back);
    if (cycle.ipoc != ipoc || cycle.replied || cycle.duplicate) continue;
    cycle.replied = datagram.time;
    return;
  }
}

void FlightRecorder::send_failed() {
  if (size_ > 0) newest(0).send_failed = true;
}

std::string FlightRecorder::reason() const {
  const auto cycle_time = link_.cycle().value_or(nanoseconds(0));
  std::array<std::uint64_t, kEvents> count{};
  std::uint64_t lost = 0;
  std::uint64_t overtaken = 0;  // these fill a gap that was taken for a loss
  std::uint64_t delay = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    ++count[static_cast<std::size_t>(event(i, cycle_time))];
    lost += i > 0 ? lost_before(cycle(i)) : 0;
    if (cycle(i).reordered) ++overtaken;
    delay = std::max(delay, cycle(i).delay.value_or(0));
  }
  const auto of = [&](Event event) { return count[static_cast<std::size_t>(event)]; };
  const auto sentence = [&](std::uint64_t number, const char* one, const char* many,
                            const char* rest) {
    return "in the last " + rsi::counted(size_, "cycle") + " " + rsi::counted(number, one, many) +
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
                    link_.same_machine()
                        ? "came too late for the controller (Delay), though all left in time: see "
                          "what keeps it busy on this machine"
                        : "came too late for the controller (Delay), though all left in time: look "
                          "at the network to it");
  if (lost > overtaken)
    return sentence(lost - overtaken, "telegram", "telegrams",
                    link_.same_machine()
                        ? "never came: see what kept the sender on this machine busy, and the "
                          "receive buffer"
                        : "never came: look at cable, switch and receive buffer");
  return {};
}

std::string FlightRecorder::csv() const {
  const auto cycle_time = link_.cycle().value_or(nanoseconds(0));
  std::string text =
      "received_s,replied_s,ipoc,latency_us,delay_packets,lost_before_packets,event\n";
  for (std::size_t i = 0; i < size_; ++i) {
    const Cycle& row = cycle(i);
    text += exact_seconds(row.received) + ",";
    if (row.replied) text += exact_seconds(*row.replied);
    text += "," + optional_number(row.ipoc) + ",";
    if (row.replied) text += fixed(us(*row.replied - row.received), 3);
    text += "," + optional_number(row.delay) + "," + std::to_string(lost_before(row)) + ",";
    text.append(FlightRecorder::text(event(i, cycle_time))).append("\n");
  }
  return text;
}

std::string_view FlightRecorder::text(Event event) {
  constexpr std::array<std::string_view, kEvents> kTexts{"answered",   "late",        "superseded",
                                                         "unanswered", "send_failed", "received",
                                                         "duplicate",  "malformed"};
  return kTexts[static_cast<std::size_t>(event)];
}

const FlightRecorder::Cycle& FlightRecorder::cycle(std::size_t index) const {
  return cycles_[(next_ + kCycles - size_ + index) % kCycles];
}

FlightRecorder::Cycle& FlightRecorder::newest(std::size_t back) {
  return cycles_[(next_ + kCycles - 1 - back) % kCycles];
}

FlightRecorder::Event FlightRecorder::event(std::size_t index, nanoseconds cycle_time) const {
  const Cycle& seen = cycle(index);
  if (seen.send_failed) return Event::send_failed;
  if (seen.malformed) return Event::malformed;
  if (seen.replied) {
    const bool late = cycle_time.count() > 0 && *seen.replied - seen.received > cycle_time;
    return late ? Event::late : Event::answered;
  }
  if (seen.duplicate) return Event::duplicate;
  if (!expects_replies_) return Event::received;
  const nanoseconds since = cycle(size_ - 1).received - seen.received;
  for (std::size_t later = index + 1; later < size_; ++later)
    if (const auto& replied = cycle(later).replied)
      return *replied - seen.received <= 2 * cycle_time ? Event::superseded : Event::unanswered;
  return since < cycle_time || index + 1 == size_ ? Event::received : Event::unanswered;
}

std::uint64_t FlightRecorder::lost_before(const Cycle& cycle) const {
  const auto step = link_.step();
  return step && cycle.rise > *step ? cycle.rise / *step - 1 : 0;
}

}  // namespace sweepd
