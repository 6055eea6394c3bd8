#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "rsi/datagram.hpp"
#include "rsi/link/link_report.hpp"
#include "rsi/link/link_statistics.hpp"
#include "rsi/telegram/telegram.hpp"

namespace rsi {

/// Watches a link from the datagrams of one controller in both directions, in the order in which
/// they came and went; the order counts, their time stamps may jump. A reply is paired with its
/// telegram by the IPOC, over the last 512 telegrams at least. A datagram that is no telegram but
/// carries an IPOC counts as one here: it came, and can be answered.
///
/// A jump of the clock is told from a delay by what follows: after a delay the telegrams that
/// waited come at once, after a jump the next ones come at their usual pace. It is seen backwards
/// where time goes back, and forwards from three cycles on if the IPOC counts milliseconds, else
/// from an hour on.
///
/// Constant memory, some 200 kB. One thread.
class LinkMonitor {
 public:
  /// From the controller, whatever it holds.
  void telegram(const Datagram& datagram);
  /// The same for who has parsed it already.
  void telegram(const Datagram& datagram, const Telegram& telegram, Defect defect);
  /// To the controller.
  void reply(const Datagram& datagram);

  /// So far. A telegram that came less than a cycle before the end is not missing its reply yet.
  [[nodiscard]] LinkReport report() const;

 private:
  using Nanoseconds = std::chrono::nanoseconds;

  struct Cycle {
    std::uint64_t ipoc = 0;
    Timestamp received{};
    std::optional<Timestamp> replied;
    Arrival arrival = Arrival::in_order;
    std::uint64_t rise = 0;  // of the IPOC since the telegram in order before; 0 where none counts
    Nanoseconds since{};     // that telegram, by the clock
    std::uint64_t delay = 0;
    bool begins_late_run = false;
    // Laid out when it is settled:
    bool clock_stepped = false;               // since the telegram before
    bool timed = false;                       // its latency can be trusted
    Nanoseconds at{};                         // since the first telegram, without clock steps
    std::optional<Nanoseconds> next_reply{};  // when the next one to a newer telegram left
  };

  void lay_out();
  [[nodiscard]] bool clock_stepped(std::size_t index) const;
  [[nodiscard]] Nanoseconds deviation(const Cycle& cycle) const;
  void settle(std::size_t count, bool at_end);
  void score_arrival(const Cycle& cycle);
  void score_late_run(const Cycle& cycle);
  void score_reply(const Cycle& cycle, bool at_end);
  [[nodiscard]] bool replied_in_time(const Cycle& cycle);
  void end_run(Place& run, WorstPlaces& runs);

  /// What becomes of a telegram is settled when enough of the later ones are known.
  static constexpr std::size_t kMost = 1024;
  static constexpr std::size_t kBatch = 512;

  LinkStatistics link_;
  Telegram telegram_;
  std::size_t delay_hint_ = 0;
  std::array<Cycle, kMost> cycles_{};
  std::size_t size_ = 0;
  std::uint64_t late_runs_ = 0;
  std::optional<Cycle> newest_;  // in order
  Nanoseconds settled_until_{};  // its time since the first telegram
  Nanoseconds unit_ = std::chrono::milliseconds(1);
  Nanoseconds cycle_{};
  Place late_run_;
  Place silent_run_;
  LinkReport report_;
};

}  // namespace rsi
