#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

namespace sweepd::test {

/// Waits for what another thread or process does; false if it takes unreasonably long. While the
/// machine stood still, nobody waited.
inline bool eventually(const std::function<bool()>& condition) {
  using Clock = std::chrono::steady_clock;
  constexpr Clock::duration kPatience = std::chrono::seconds(30);
  constexpr Clock::duration kLongestTurn = std::chrono::seconds(1);
  Clock::duration waited{};
  for (auto last = Clock::now(); !condition();) {
    if (waited > kPatience) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto now = Clock::now();
    waited += std::min(now - last, kLongestTurn);
    last = now;
  }
  return true;
}

}  // namespace sweepd::test
