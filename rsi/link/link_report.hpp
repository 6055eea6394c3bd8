#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "rsi/datagram.hpp"
#include "rsi/link/latency_histogram.hpp"
#include "rsi/link/link_statistics.hpp"

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

/// What became of a telegram that is to be answered.
enum class Fate { in_time, late, superseded, unanswered };
/// Told from the times from its coming to its reply, and to the next reply to a newer telegram; as
/// far as there are any. `cycle`: zero while it is not known.
[[nodiscard]] constexpr Fate fate(std::optional<std::chrono::nanoseconds> to_reply,
                                  std::optional<std::chrono::nanoseconds> to_next_reply,
                                  std::chrono::nanoseconds cycle) noexcept {
  if (to_reply) return cycle.count() > 0 && *to_reply > cycle ? Fate::late : Fate::in_time;
  return to_next_reply && *to_next_reply <= 2 * cycle ? Fate::superseded : Fate::unanswered;
}

/// What became of the telegrams, each counted once however often it came or was answered.
struct ReplyCounts {
  /// Replies seen, of any kind. With none, and none that was to be sent, the rest is zero too.
  std::uint64_t sent = 0;
  std::uint64_t failed = 0;  ///< the system refused to send these
  std::uint64_t in_time = 0;
  std::uint64_t late = 0;        ///< answered later than one cycle after the telegram came
  std::uint64_t superseded = 0;  ///< no reply of its own, but one to a newer telegram within two
                                 ///< cycles: a server answers only the newest of those that wait
  std::uint64_t unanswered = 0;  ///< no reply at all, or long after
  std::uint64_t untimed = 0;   ///< among those in time: the clock was set meanwhile, or the stamps
                               ///< of telegram and reply contradict each other
  std::uint64_t repeated = 0;  ///< replies to what was answered already
  std::uint64_t stray = 0;     ///< replies whose IPOC no telegram had
  /// Not answered on purpose, since the beginning of their stream was not seen; in none of the
  /// above.
  std::uint64_t withheld = 0;

  [[nodiscard]] std::uint64_t not_in_time() const { return late + superseded + unanswered; }
};

/// How the link between a controller and its RSI server did, seen from where the datagrams were
/// stamped: mostly the server's machine.
struct LinkReport {
  Timestamp start{};                    ///< of the first telegram, by the clock of that machine
  std::chrono::nanoseconds duration{};  ///< to the last telegram; setting the clock does not count

  bool same_machine = false;  ///< telegrams did not come over a network: loopback, one address

  // From the controller.
  LinkCounts link;
  std::uint64_t malformed = 0;        ///< datagrams that are no whole telegram
  std::uint64_t unanswerable = 0;     ///< of these, without an IPOC that could be found
  std::optional<std::uint64_t> step;  ///< of the IPOC, per cycle
  std::chrono::nanoseconds cycle{};   ///< zero before two telegrams came in order
  bool ipoc_counts_ms = true;         ///< else the cycle is the median time between telegrams
  Place longest_gap;      ///< most telegrams that did not come in a row: `amount`, before `ipoc`
  WorstPlaces late_runs;  ///< runs of late replies by the controller's Delay: `amount` replies
  /// Size of the difference between the time from telegram to telegram and the rise of the IPOC.
  LatencyHistogram jitter;
  std::chrono::nanoseconds earliest{};  ///< the least such difference, negative
  std::chrono::nanoseconds latest{};    ///< the greatest

  /// Packets of either direction that passed a tap unseen: what counts as lost, unanswered or stray
  /// may be among them.
  std::uint64_t missed_by_tap = 0;
  /// Datagrams of either direction that the server did not hand over, as its queue was full: among
  /// these, too.
  std::uint64_t queue_full = 0;
  /// Packets that were on the link, though not counted here.
  [[nodiscard]] std::uint64_t unseen() const { return missed_by_tap + queue_full; }
  /// Of a session that was cut, told by what was recorded of it: what a tap missed, what was not
  /// answered on purpose and what the recording lacks is not known.
  bool from_recording = false;

  // To the controller.
  ReplyCounts replies;
  LatencyHistogram latency;  ///< from a telegram's reception to its reply
  WorstPlaces slowest;       ///< replies: `amount` in nanoseconds
  WorstPlaces silent_runs;   ///< telegrams in a row without a reply in time: `amount` of them
  /// The longest from a superseded telegram's coming to the reply to a newer one.
  std::chrono::nanoseconds longest_superseded{};

  /// The machine's clock and the IPOC parted for good: the clock was set, or the sender paused with
  /// its IPOC. Neither jitter nor latency contain it.
  std::uint64_t clock_steps = 0;
  std::uint64_t clock_steps_back = 0;             ///< of these: to an earlier time
  std::chrono::nanoseconds largest_clock_step{};  ///< negative: backwards
};

}  // namespace rsi
