#pragma once

#include <array>
#include <chrono>
#include <cstdint>

namespace rsi {

/// The addresses that were heard on a port, and which of them began their stream there.
///
/// Silence is what was seen to be silent, by one steady clock: a look at the port that took all
/// there was shows that nothing else had come when it began. So neither a standstill of this
/// program, behind which telegrams wait, nor a step of the system's clock looks like silence.
///
/// Of the last few addresses, in fixed memory: one that was pushed out by others counts as heard
/// until then. One thread.
class Callers {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// Between two telegrams of one stream there is less.
  static constexpr std::chrono::seconds kSilence{1};

  /// The port is there, or datagrams were lost unseen: nobody is known to have been silent before.
  void deaf_until(Time time) noexcept;
  /// All that had come by `time` was heard.
  void heard_all_until(Time time) noexcept { heard_all_ = time; }
  /// A datagram of this address was taken from the port by `now`.
  void hear(std::uint32_t address, Time now) noexcept;

  /// Whether its stream was heard from the beginning: since the first datagram behind a second of
  /// silence it counts as that, whatever pauses follow.
  [[nodiscard]] bool began(std::uint32_t address) const noexcept;

 private:
  struct Caller {
    std::uint32_t address = 0;  // 0: a free place
    Time heard;
    bool began = false;
  };

  [[nodiscard]] Caller& place_of(std::uint32_t address) noexcept;

  std::array<Caller, 8> callers_{};
  Time unknown_until_;  // before this, an address without a place may have been heard
  Time heard_all_;
};

}  // namespace rsi
