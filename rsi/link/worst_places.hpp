#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <span>

namespace rsi {

/// Something that went wrong, and where in the stream to look for it.
struct Place {
  std::chrono::nanoseconds at{};  ///< since the first telegram
  std::uint64_t ipoc = 0;
  std::int64_t amount = 0;  ///< how bad: nanoseconds or a count, as the owner says
};

/// The ten worst places, the worst first; of equals the first seen. Adding neither allocates nor
/// throws.
class WorstPlaces {
 public:
  void add(const Place& place) noexcept {
    const auto all = places();
    const auto better = [&](const Place& kept) { return kept.amount < place.amount; };
    const auto at =
        static_cast<std::size_t>(std::find_if(all.begin(), all.end(), better) - all.begin());
    if (at == kMost) return;
    size_ = std::min(size_ + 1, kMost);
    std::move_backward(places_.begin() + static_cast<std::ptrdiff_t>(at),
                       places_.begin() + static_cast<std::ptrdiff_t>(size_ - 1),
                       places_.begin() + static_cast<std::ptrdiff_t>(size_));
    places_[at] = place;
  }

  [[nodiscard]] std::span<const Place> places() const noexcept { return {places_.data(), size_}; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] const Place& worst() const noexcept { return places_.front(); }

 private:
  static constexpr std::size_t kMost = 10;
  std::array<Place, kMost> places_{};
  std::size_t size_ = 0;
};

}  // namespace rsi
