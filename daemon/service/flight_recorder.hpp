#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rsi/datagram.hpp"
#include "rsi/link/link_statistics.hpp"
#include "rsi/telegram/telegram.hpp"

namespace sweepd {

/// Keeps the last 256 cycles of a stream, to show what went before when it ends badly. Fed with the
/// datagrams of one controller in both directions, in the order in which they came and went.
/// Constant memory; writes no file. One thread.
class FlightRecorder {
 public:
  static constexpr std::size_t kCycles = 256;

  /// `expects_replies`: false for a controller with ONLYSEND.
  explicit FlightRecorder(bool expects_replies) : expects_replies_(expects_replies) {}

  /// From the controller, whatever it holds.
  void telegram(const rsi::Datagram& datagram);
  /// The same for who has parsed it already.
  void telegram(const rsi::Datagram& datagram, const rsi::Telegram& telegram, rsi::Defect defect);
  /// To the controller.
  void reply(const rsi::Datagram& datagram);
  /// The system refused to send the reply to the newest telegram.
  void send_failed();

  /// Why the stream ended badly, as a sentence: in the kept cycles a reply could not be sent, is
  /// missing or later than a cycle, the controller reports Delay, or telegrams were malformed or
  /// lost. Of several reasons the one that most likely stopped the robot. Empty if it ended well.
  [[nodiscard]] std::string reason() const;
  [[nodiscard]] bool ended_badly() const { return !reason().empty(); }

  /// A row a cycle, the oldest first. Times in seconds since the Unix epoch (UTC) with nine
  /// decimals; what is not known is empty. The events:
  ///   answered      in time
  ///   late          answered later than a cycle
  ///   superseded    no reply of its own, but one to a newer telegram within two cycles
  ///   unanswered    no reply
  ///   send_failed   the system refused to send the reply
  ///   received      no reply is expected, or the cycle was not over when the stream ended
  ///   duplicate     its IPOC was there before
  ///   malformed     no whole telegram
  [[nodiscard]] std::string csv() const;

 private:
  enum class Event {
    answered,
    late,
    superseded,
    unanswered,
    send_failed,
    received,
    duplicate,
    malformed
  };
  static constexpr std::size_t kEvents = 8;

  struct Cycle {
    rsi::Timestamp received{};
    std::optional<rsi::Timestamp> replied;
    std::optional<std::uint64_t> ipoc;
    std::optional<std::uint64_t> delay;
    std::uint64_t rise = 0;  // of the IPOC since the telegram in order before; 0: none counts
    bool duplicate = false;
    bool reordered = false;
    bool malformed = false;
    bool send_failed = false;
  };

  [[nodiscard]] static std::string_view text(Event event);
  /// Of the cycles that are kept, 0 is the oldest.
  [[nodiscard]] const Cycle& cycle(std::size_t index) const;
  Cycle& newest(std::size_t back);
  [[nodiscard]] Event event(std::size_t index, std::chrono::nanoseconds cycle_time) const;
  [[nodiscard]] std::uint64_t lost_before(const Cycle& cycle) const;

  bool expects_replies_;
  rsi::LinkStatistics link_;
  rsi::Telegram telegram_;
  std::size_t delay_hint_ = 0;
  std::optional<std::uint64_t> newest_ipoc_;  // in order
  std::array<Cycle, kCycles> cycles_{};
  std::size_t next_ = 0;
  std::size_t size_ = 0;
};

}  // namespace sweepd
