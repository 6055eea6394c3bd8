#include "rsi/callers.hpp"

#include <algorithm>

namespace rsi {

void Callers::deaf_until(Time time) noexcept {
  unknown_until_ = time;
  for (auto& caller : callers_)
    if (caller.address != 0) caller.heard = time;
}

void Callers::hear(std::uint32_t address, Time now) noexcept {
  Caller& caller = place_of(address);
  if (heard_all_ - caller.heard >= kSilence) caller.began = true;
  caller.heard = now;
}

bool Callers::began(std::uint32_t address) const noexcept {
  return std::any_of(callers_.begin(), callers_.end(), [&](const Caller& caller) {
    return caller.address == address && caller.began;
  });
}

Callers::Caller& Callers::place_of(std::uint32_t address) noexcept {
  Caller* longest_unheard = callers_.data();
  for (auto& caller : callers_) {
    if (caller.address == address) return caller;
    if (caller.heard < longest_unheard->heard) longest_unheard = &caller;
  }
  if (longest_unheard->address != 0)
    unknown_until_ = std::max(unknown_until_, longest_unheard->heard);
  *longest_unheard = {address, unknown_until_, false};
  return *longest_unheard;
}

}  // namespace rsi
