#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "rsi/endpoint.hpp"

namespace rsi {

/// The addresses that were heard on a port: which of them is the controller, and which began their
/// stream there.
///
/// The controller is the first that streams: several IPOCs in step within a second, which one that
/// speaks now and then never sends. It stays so until it has not streamed for a second; before, and
/// then, anyone may become it.
///
/// Silence is what was seen to be silent, by one steady clock: a look at the port that took all
/// there was shows that nothing else had come when it began. So neither a standstill of this
/// program, behind which telegrams wait, nor a step of the system's clock looks like silence. A
/// network that was down does: what comes behind it from the same port, with the IPOC that the time
/// asks for, goes on. RSI that was switched on again has another port, and an IPOC of its own.
///
/// Of the last few addresses, in fixed memory: one that was pushed out by others counts as heard
/// until then. One thread.
class Callers {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// Between two telegrams of one stream there is less.
  static constexpr std::chrono::seconds kSilence{1};
  /// So many IPOCs that rise, each by less than a second's, are a stream. Where an IPOC rises by
  /// more a telegram, as one that does not count milliseconds may, two such rises tell its step.
  static constexpr unsigned kSteps = 3;

  /// The port is there, or datagrams were lost unseen: nobody is known to have been silent before.
  void deaf_until(Time time) noexcept;
  /// All that had come by `time` was heard.
  void heard_all_until(Time time) noexcept { heard_all_ = time; }
  /// A datagram of this address was taken from the port by `now`. Whether it is the controller's,
  /// or may become it.
  bool hear(std::uint32_t address, Time now) noexcept;
  [[nodiscard]] bool may_be_controller(std::uint32_t address) const noexcept;
  /// The datagram just heard was a telegram. `missed`: replies in a row that its controller says it
  /// has missed.
  void telegram(const Endpoint& source, std::uint64_t ipoc, Time now,
                std::uint64_t missed = 0) noexcept;
  /// Nobody is the controller any more.
  void forget_controller() noexcept { controller_ = 0; }

  /// How much it looks like a controller, from 0 to kSteps: it streams; nothing without an IPOC.
  [[nodiscard]] std::optional<unsigned> rank(std::uint32_t address) const noexcept;

  /// Whether its stream was heard from the beginning: since the first telegram behind a second of
  /// silence, which does not go on what was heard before and has not missed replies for long, it
  /// counts as that, whatever pauses follow.
  [[nodiscard]] bool began(std::uint32_t address) const noexcept;

 private:
  struct Telegram {
    std::uint64_t ipoc = 0;
    Time at;
  };
  /// What a stream that did not begin here has sent, from one port and with an IPOC that rises.
  struct Stream {
    std::uint16_t port = 0;  // 0: there is none
    Telegram first, last;

    void take(std::uint16_t from, const Telegram& next) noexcept;
    [[nodiscard]] bool goes_on(std::uint16_t from, const Telegram& next) const noexcept;
    [[nodiscard]] bool comes_late(const Telegram& next) const noexcept;
  };
  struct Caller {
    std::uint32_t address = 0;  // 0: a free place
    Time heard;
    bool silent = false;  // for a second, and no telegram has come since
    bool began = false;
    Stream stream;
    bool spoke = false;  // a telegram
    bool odd = false;    // the last one was out of step,
    std::uint64_t odd_ipoc = 0;
    std::uint64_t step = 0;  // where that is large
    unsigned steps = 0;      // in step, since `first`
    std::uint64_t ipoc = 0;  // the newest
    Time first;
    Time streamed;  // when there were kSteps
  };

  [[nodiscard]] const Caller* find(std::uint32_t address) const noexcept;

  [[nodiscard]] Caller& place_of(std::uint32_t address) noexcept;

  std::array<Caller, 8> callers_{};
  Time unknown_until_;  // before this, an address without a place may have been heard
  Time heard_all_;
  std::uint32_t controller_ = 0;  // the one that streams; 0: none
};

}  // namespace rsi
