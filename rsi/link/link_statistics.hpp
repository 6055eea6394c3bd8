#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "rsi/datagram.hpp"

namespace rsi {

/// What one count of the IPOC lasts. `per_count`: times from one telegram to the next, each divided
/// by the rise of the IPOC; they may be left in another order. Where their median is within a
/// quarter of a millisecond of 1 ms the IPOC counts milliseconds, as on every controller, and the
/// answer is exactly 1 ms. Some simulators raise it by one a telegram, or keep another time than
/// they print; there the median is all there is, up to an hour. 1 ms if `per_count` is empty, or if
/// all times are the same, as where a recording has none.
[[nodiscard]] std::chrono::nanoseconds ipoc_unit(
    std::span<std::chrono::nanoseconds> per_count) noexcept;

/// How a telegram came in.
enum class Arrival {
  in_order,
  duplicate,  ///< a copy: the same telegram came shortly before
  reordered,  ///< older than the newest one, seen for the first time
  restart,    ///< the controller's RSI began anew: its IPOC or its port jumped, or its IPOC fell
              ///< back to one that another telegram had
  completed,  ///< the whole telegram of a cycle of which something else came before
  stray,      ///< no whole telegram, and its IPOC would be a restart: it is not believed
};

/// What happened to a controller's telegrams on the way. Counts since the first of them.
struct LinkCounts {
  std::uint64_t telegrams = 0;   ///< received with an IPOC, duplicates included, strays not
  std::uint64_t lost = 0;        ///< cycles between first and last of which no telegram came
  std::uint64_t duplicated = 0;  ///< telegrams that came again
  std::uint64_t reordered = 0;   ///< telegrams overtaken by a later one
  std::uint64_t restarts = 0;
  /// Restarts that went back to the sender before the last one: two of them stream at once.
  std::uint64_t alternations = 0;
  std::array<Endpoint, 2> alternating{};  ///< the two that did so last
  /// Replies that the controller missed in time, by its Delay; not known where it sends none.
  std::optional<std::uint64_t> late_replies;
  /// Those that it had missed before the first telegram that was seen; not among the former.
  std::uint64_t missed_before = 0;
  std::uint64_t late_runs = 0;  ///< runs of consecutive late replies
  std::uint64_t longest_late_run = 0;

  /// Of which a telegram came, or was lost.
  [[nodiscard]] std::uint64_t cycles() const { return telegrams - duplicated + lost; }
};

/// Link statistics of one controller, from its telegrams in order of reception. The IPOC's step per
/// cycle is learned: 4 or 12 (ms) on controllers, 1 on simulators; that it passes 2^64 is nothing
/// special. Constant memory, some 20 kB; not thread-safe.
///
/// An IPOC that falls back is that of a copy, of a latecomer or of an RSI that began anew. A copy
/// has the content of what was seen, and comes within a second of it. A latecomer fills a gap among
/// the last 256 telegrams. All else is a restart, but what is `cut` restarts no stream of whole
/// telegrams. So is an IPOC that runs ahead by more than can have been sent in the time that passed
/// since the most punctual telegrams: what was not sent was not lost.
class LinkStatistics {
 public:
  /// `delay`: the telegram's <Delay D=>, where it has one. What a datagram holds that is `cut` is
  /// not compared.
  Arrival add(const Datagram& datagram, std::uint64_t ipoc, std::optional<std::uint64_t> delay);

  [[nodiscard]] LinkCounts counts() const;
  /// Late replies in a row up to the last telegram that had a Delay.
  [[nodiscard]] std::uint64_t late_run() const { return delay_.value_or(0) - delay_before_; }
  /// The telegrams never were on a network: they come from loopback, or from their own destination.
  [[nodiscard]] bool same_machine() const { return same_machine_; }

  /// IPOC's rise from one cycle to the next; nothing before two telegrams came in order.
  [[nodiscard]] std::optional<std::uint64_t> step() const {
    return steps_[usual_step_] > 0 ? std::optional(usual_step_) : std::nullopt;
  }
  /// The same since the last restart, as soon as that tells: RSI may begin anew in another cycle.
  /// Before, the larger one of the two counts, so that none is lost for what is not known yet.
  [[nodiscard]] std::optional<std::uint64_t> step_of_run() const;

  /// What one count of the IPOC lasts by the last 1024 telegrams, see ipoc_unit().
  /// 1 ms too where stamps are coarser than eight cycles.
  [[nodiscard]] std::chrono::nanoseconds unit() const;
  /// Whether the IPOC is a clock that counts milliseconds, by unit() so far. Until 64 telegrams
  /// have told it is, unless it rises by one a telegram or runs ahead of the time of reception.
  /// Where telegrams come faster than any controller sends them, times tell nothing, and it is.
  [[nodiscard]] bool counts_ms() const;
  /// From one telegram to the next: that unit times the step. Nothing without a step, nor where
  /// telegrams have no times and their IPOC only counts them.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> cycle() const;

 private:
  /// Telegrams between two restarts.
  struct Run {
    std::uint64_t oldest = 0;  ///< IPOC
    std::uint64_t newest = 0;
    std::uint64_t distinct = 0;
    std::uint64_t whole = 0;    ///< of these, not cut
    std::uint64_t in_step = 0;  ///< that came a step of the run after the one before
    std::uint64_t rise = 0;     ///< the most frequent one, as far as most are alike,
    std::uint64_t votes = 0;    ///< by so many more than all others
  };
  struct Seen {
    std::uint64_t ipoc = 0;
    std::optional<std::uint64_t> content;  ///< a hash; nothing of a cut datagram
    Timestamp time{};
  };

  struct Milestone {
    std::uint64_t ipoc = 0;
    Timestamp time{};
  };

  [[nodiscard]] std::uint64_t lost_in_run() const;
  [[nodiscard]] Arrival judge(const Seen& came, const Endpoint& source) const;
  [[nodiscard]] Arrival judge_fallen(const Seen& came) const;
  [[nodiscard]] bool ran_ahead(const Seen& came) const;
  /// Whether telegrams come faster than any controller sends them, as where someone tries what a
  /// link bears.
  [[nodiscard]] bool hurries() const;
  [[nodiscard]] const Seen* seen(std::uint64_t ipoc) const;
  /// The last one in order.
  [[nodiscard]] const Milestone& newest() const {
    return milestones_[(next_milestone_ + milestones_.size() - 1) % milestones_.size()];
  }
  void complete(const Seen& came);
  void learn_pace(std::uint64_t rise, const Milestone& now);
  void count_late(std::uint64_t ipoc, std::uint64_t delay);

  /// Telegrams that are remembered, and times between telegrams.
  static constexpr std::uint64_t kRecent = 256;
  static constexpr std::size_t kPaces = 1024;
  /// From so many telegrams in step on an IPOC out of step is not of the same run.
  static constexpr std::uint64_t kSureOfStep = 16;
  /// By so many votes a run tells its step.
  static constexpr std::uint64_t kTellsStep = 8;
  /// A latecomer from before the first telegram is older than that by no more cycles.
  static constexpr std::uint64_t kBeforeFirst = 8;
  /// A copy comes no later after the telegram.
  static constexpr std::chrono::seconds kCopyWithin{1};
  /// A rise by more than a minute is no loss but a restart.
  static constexpr std::uint64_t kLongestGap = 60'000;
  static constexpr std::size_t kLargestStep = 255;
  /// So many times between telegrams tell what the IPOC counts.
  static constexpr std::uint64_t kTells = 64;

  LinkCounts counts_;
  Run run_;
  Endpoint source_;
  Endpoint source_before_;  // what was heard before it changed to source_
  bool same_machine_ = false;
  std::optional<std::uint64_t> delay_;  // the last one of this run, and its telegram
  std::uint64_t delay_ipoc_ = 0;
  std::uint64_t delay_before_ = 0;                       // of the late run, what Delay began at
  std::array<std::uint64_t, kLargestStep + 1> steps_{};  // how often IPOC rose by so much
  std::uint64_t usual_step_ = 0;                         // the most frequent, of equals the least
  std::array<Seen, kRecent> recent_;  // of this run, number k at k modulo kRecent
  /// The last telegrams in order. A pace is taken over all of them: a machine that is busy sends
  /// and receives in bursts, within which telegrams are closer than their cycle.
  std::array<Milestone, 16> milestones_{};
  std::size_t next_milestone_ = 0;                            // the oldest
  bool has_times_ = false;                                    // not all the same
  std::array<std::chrono::nanoseconds, kPaces> per_count_{};  // time for each count that IPOC rose
  std::uint64_t paces_ = 0;
  std::chrono::nanoseconds unit_ = std::chrono::milliseconds(1);  // as it was known last
  std::chrono::nanoseconds lag_{};  // of the newest in order, behind the most punctual ones
  std::chrono::nanoseconds tick_ = std::chrono::hours(1);  // the least from one to the next
};

}  // namespace rsi
