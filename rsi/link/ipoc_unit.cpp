#include "rsi/link/ipoc_unit.hpp"

#include <algorithm>

namespace rsi {

std::chrono::nanoseconds ipoc_unit(std::span<std::chrono::nanoseconds> per_count) noexcept {
  using namespace std::chrono_literals;
  constexpr std::chrono::nanoseconds kMillisecond = 1ms;
  constexpr std::chrono::nanoseconds kTolerance = 250us;
  if (per_count.empty()) return kMillisecond;
  const auto middle = per_count.begin() + static_cast<std::ptrdiff_t>(per_count.size() / 2);
  std::nth_element(per_count.begin(), middle, per_count.end());
  if (*middle == std::chrono::nanoseconds(0)) return kMillisecond;
  return std::chrono::abs(*middle - kMillisecond) <= kTolerance
             ? kMillisecond
             : std::min<std::chrono::nanoseconds>(*middle, 1h);
}

}  // namespace rsi
