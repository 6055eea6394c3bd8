#include "rsi/server/callers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rsi/telegram/ipoc.hpp"

namespace rsi {
namespace {

/// A cycle in nanoseconds is less.
constexpr std::uint64_t kLargestStep = 100'000'000;
/// So many steps at once: some telegrams were lost.
constexpr std::uint64_t kMostSteps = 4;

/// A second without a reply has at least so many cycles, and the first telegrams may be lost.
constexpr std::uint64_t kLongMissed = 20;

/// Two rises of one step, which a clock may shorten or lengthen.
bool are_alike(std::uint64_t rise, std::uint64_t other) noexcept {
  const auto [less, more] = std::minmax(rise, other);
  return more <= kLargestStep && less >= more - more / 4;
}

}  // namespace

void Callers::Stream::take(std::uint16_t from, const Telegram& next) noexcept {
  const bool goes_back = next.ipoc < last.ipoc && !comes_late(next);
  if (port != from || goes_back) *this = {from, next, next};
  if (next.ipoc > last.ipoc) last = next;
}

bool Callers::Stream::comes_late(const Telegram& next) const noexcept {
  return next.ipoc == last.ipoc || was_overtaken(last.ipoc, next.ipoc);
}

bool Callers::Stream::goes_on(std::uint16_t from, const Telegram& next) const noexcept {
  using Seconds = std::chrono::duration<double>;
  constexpr Seconds kTellsPace{0.1};
  if (port == 0 || port != from) return false;
  if (comes_late(next)) return true;
  if (next.ipoc < last.ipoc) return false;
  const Seconds heard = last.at - first.at;
  if (heard < kTellsPace) return true;  // how fast its IPOC rises is not known
  const double a_second = static_cast<double>(last.ipoc - first.ipoc) / heard.count();
  const Seconds silent = next.at - last.at;
  const double off = static_cast<double>(next.ipoc - last.ipoc) - a_second * silent.count();
  return std::abs(off) <= a_second * (0.25 * silent.count() + kTellsPace.count());
}

void Callers::deaf_until(Time time) noexcept {
  unknown_until_ = time;
  for (auto& caller : callers_)
    if (caller.address != 0) caller.heard = time;
}

bool Callers::hear(std::uint32_t address, Time now) noexcept {
  const bool may_be = may_be_controller(address);
  Caller& caller = place_of(address);
  if (heard_all_ - caller.heard >= kSilence) {
    caller.silent = true;
    caller.spoke = false;
  }
  caller.heard = now;
  return may_be;
}

bool Callers::may_be_controller(std::uint32_t address) const noexcept {
  if (controller_ == 0 || controller_ == address) return true;
  const Caller* const controller = find(controller_);
  return controller == nullptr || heard_all_ - controller->streamed >= kSilence;
}

void Callers::telegram(const Endpoint& source, std::uint64_t ipoc, Time now,
                       std::uint64_t missed) noexcept {
  Caller& caller = place_of(source.address);
  const bool silent = std::exchange(caller.silent, false);
  if (const Telegram heard{ipoc, now}; !caller.began) {
    caller.began = silent && missed < kLongMissed && !caller.stream.goes_on(source.port, heard);
    caller.stream.take(source.port, heard);
  }
  if (caller.spoke && was_overtaken(caller.ipoc, ipoc)) return;
  const auto rise = ipoc - caller.ipoc;
  const auto last_rise = ipoc - caller.odd_ipoc;
  const bool large = caller.odd && are_alike(last_rise, caller.odd_ipoc - caller.ipoc);
  if (large) caller.step = last_rise;
  const bool in_step =
      caller.spoke && (large || rise < std::max(kNoLatecomer, kMostSteps * caller.step));
  // One that is out of step may be damaged, two have begun anew.
  caller.odd = caller.spoke && !in_step && !caller.odd;
  caller.odd_ipoc = ipoc;
  if (caller.odd) return;
  if (!in_step) caller.step = 0;
  caller.spoke = true;
  caller.ipoc = ipoc;
  if (!in_step || now - caller.first > kSilence) {
    caller.steps = 0;
    caller.first = now;
  } else if (rise > 0) {
    ++caller.steps;
  }
  if (caller.steps < kSteps) return;
  caller.steps = 0;
  caller.first = caller.streamed = now;
  if (may_be_controller(source.address)) controller_ = source.address;
}

std::optional<unsigned> Callers::rank(std::uint32_t address) const noexcept {
  const Caller* const caller = find(address);
  if (caller == nullptr || !caller->spoke) return std::nullopt;
  return caller->heard - caller->streamed < kSilence ? kSteps : caller->steps;
}

bool Callers::began(std::uint32_t address) const noexcept {
  const Caller* const caller = find(address);
  return caller != nullptr && caller->began;
}

const Callers::Caller* Callers::find(std::uint32_t address) const noexcept {
  for (const auto& caller : callers_)
    if (caller.address == address) return &caller;
  return nullptr;
}

Callers::Caller& Callers::place_of(std::uint32_t address) noexcept {
  const auto is_kept = [&](const Caller& caller) {
    return controller_ != 0 && caller.address == controller_;
  };
  Caller* longest_unheard = &callers_[is_kept(callers_[0]) ? 1 : 0];
  for (auto& caller : callers_) {
    if (caller.address == address) return caller;
    if (!is_kept(caller) && caller.heard < longest_unheard->heard) longest_unheard = &caller;
  }
  if (longest_unheard->address != 0)
    unknown_until_ = std::max(unknown_until_, longest_unheard->heard);
  *longest_unheard = {};
  longest_unheard->address = address;
  longest_unheard->heard = unknown_until_;
  return *longest_unheard;
}

}  // namespace rsi
