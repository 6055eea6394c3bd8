#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rsi/datagram.hpp"
#include "rsi/link/link_report.hpp"
#include "rsi/link/link_statistics.hpp"
#include "rsi/telegram/telegram.hpp"

namespace rsi {

/// Something that came from the controller, and what became of it.
struct Cycle {
  Timestamp received{};
  std::optional<Timestamp> replied;
  std::optional<std::uint64_t> ipoc;   ///< nothing: none could be found
  std::optional<std::uint64_t> delay;  ///< as the controller told it
  Arrival arrival = Arrival::in_order;
  std::uint64_t rise = 0;    ///< of the IPOC since the telegram in order before; 0: none counts
  bool malformed = false;    ///< no whole telegram
  bool send_failed = false;  ///< the system refused to send the reply

  /// What begins no cycle is only kept for who looks at the last ones.
  [[nodiscard]] bool counts() const {
    return ipoc && arrival != Arrival::duplicate && arrival != Arrival::completed &&
           arrival != Arrival::stray;
  }
};

/// Of one of the last cycles, by what is known of those after it. Times are as they were stamped.
[[nodiscard]] Fate fate(std::span<const Cycle> cycles, std::size_t index,
                        std::chrono::nanoseconds cycle);

/// A link, from the datagrams of one controller in both directions, in the order in which they came
/// and went; the order counts, their time stamps may jump. All that is told of a link comes from
/// here. A reply is paired with its telegram by the IPOC, over the last 512 datagrams at least. A
/// datagram that is no telegram but carries an IPOC counts as one: it came, and can be answered.
///
/// A jump of the clock is told from a delay by what follows: after a delay the telegrams that
/// waited come at once, after a jump the next ones come at their usual pace. It is seen backwards
/// where time goes back, and forwards from three cycles on if the IPOC counts milliseconds, else
/// from an hour on.
///
/// Constant memory, some 200 kB. One thread.
class Link {
 public:
  /// From the controller, whatever it holds. How it arrived; nothing without an IPOC.
  std::optional<Arrival> telegram(const Datagram& datagram);
  /// The same for who has parsed it already.
  std::optional<Arrival> telegram(const Datagram& datagram, const Telegram& telegram,
                                  Defect defect);
  /// To the controller. Without a payload: the system refused to send it.
  void reply(const Datagram& datagram);

  /// So far. A telegram that came less than a cycle before the end is not missing its reply yet.
  [[nodiscard]] LinkReport report() const;
  struct Reports {
    LinkReport now;      ///< report()
    LinkReport settled;  ///< without what became of the newest kUnsettled datagrams
  };
  /// What became of the newest ones, those to come may show in another light: counters, which
  /// cannot take back what they have told, go by what is settled.
  [[nodiscard]] Reports reports() const;
  static constexpr std::size_t kUnsettled = 64;
  [[nodiscard]] const LinkStatistics& statistics() const { return statistics_; }

  static constexpr std::size_t kLast = 256;
  /// The newest that came, `most` and kLast at most, the oldest first.
  [[nodiscard]] std::vector<Cycle> last(std::size_t most = kLast) const;

 private:
  using Nanoseconds = std::chrono::nanoseconds;

  struct Kept : Cycle {
    Nanoseconds since{};  // the telegram in order before, by the clock
    bool begins_late_run = false;
    std::int64_t late_run = 0;  // late replies in a row up to this one
    // Laid out when it is settled:
    bool clock_stepped = false;               // since the telegram before
    bool timed = false;                       // its latency can be trusted
    Nanoseconds at{};                         // since the first telegram, without clock steps
    std::optional<Nanoseconds> next_reply{};  // when the next one to a newer telegram left
  };

  [[nodiscard]] LinkReport settled() const;
  void lay_out();
  [[nodiscard]] bool clock_stepped(std::size_t index) const;
  [[nodiscard]] Nanoseconds deviation(const Kept& cycle) const;
  void settle(std::size_t count, bool at_end);
  void score_arrival(const Kept& cycle);
  void score_late_run(const Kept& cycle);
  void score_reply(const Kept& cycle, bool at_end);
  [[nodiscard]] bool replied_in_time(const Kept& cycle);
  void end_run(Place& run, WorstPlaces& runs);

  /// What becomes of a telegram is settled when enough of the later ones are known.
  static constexpr std::size_t kMost = 1024;
  static constexpr std::size_t kBatch = 512;
  static_assert(kMost - kBatch >= kLast);

  LinkStatistics statistics_;
  Telegram telegram_;
  SignalPlace delay_{"Delay", "D"};
  std::array<Kept, kMost> cycles_{};
  std::size_t size_ = 0;
  std::uint64_t late_runs_ = 0;
  struct Stamped {
    Timestamp received{};
    std::uint64_t ipoc = 0;
  };
  std::optional<Stamped> newest_;       // in order
  std::optional<Stamped> early_reply_;  // stands before its telegram in a capture, or is a stray
  Nanoseconds settled_until_{};         // its time since the first telegram
  Nanoseconds unit_ = std::chrono::milliseconds(1);
  Nanoseconds cycle_{};
  Place late_run_;
  Place silent_run_;
  LinkReport report_;
};

}  // namespace rsi
