#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rsi/link/link.hpp"

namespace rsi {

/// The last 256 cycles of a link, to show what went before when its stream ends badly.
class LastCycles {
 public:
  /// `expects_replies`: false for a controller with ONLYSEND. `withheld`: so many telegrams at the
  /// link's beginning were not answered on purpose.
  LastCycles(const Link& link, bool expects_replies, std::uint64_t withheld = 0);

  /// Why the stream ended badly, as a sentence: in the kept cycles a reply could not be sent, is
  /// missing or later than a cycle, the controller reports Delay, or telegrams were malformed or
  /// lost. Of several reasons the one that most likely stopped the robot. Empty if it ended well.
  [[nodiscard]] std::string reason() const;

  /// A row a cycle, the oldest first. Times in seconds since the Unix epoch (UTC) with nine
  /// decimals; what is not known is empty. The events:
  ///   answered      in time
  ///   late          answered later than a cycle
  ///   superseded    no reply of its own, but one to a newer telegram within two cycles
  ///   unanswered    no reply
  ///   withheld      no reply, on purpose
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
    malformed,
    withheld
  };
  static constexpr std::size_t kEvents = 9;

  [[nodiscard]] static std::string_view text(Event event);
  [[nodiscard]] Event event(std::size_t index) const;
  [[nodiscard]] std::uint64_t lost_before(const Cycle& cycle) const;

  std::vector<Cycle> cycles_;
  bool expects_replies_;
  bool same_machine_;
  std::uint64_t step_;  // of the IPOC; 0: not known
  std::chrono::nanoseconds cycle_time_;
  std::uint64_t withheld_;  // of the kept ones, the first
};

}  // namespace rsi
