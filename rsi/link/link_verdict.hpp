#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rsi/link/link_report.hpp"

namespace rsi {

/// How fit a link is for a robot that moves.
enum class Grade {
  good,
  marginal,  ///< it holds, with less in reserve than a cell should have
  bad,       ///< a controller that waits for replies is likely to stop
};
[[nodiscard]] std::string_view text(Grade grade) noexcept;

/// One sentence: what, how many, what to do. `code` names it for programs and does not change.
struct Reason {
  Grade grade = Grade::good;  ///< that this alone would give; good: only good to know
  std::string_view code;
  std::string message;
};

struct Verdict {
  Grade grade = Grade::good;    ///< the worst of the reasons
  std::vector<Reason> reasons;  ///< the worst first

  /// The message of the worst one; empty where the link is good.
  [[nodiscard]] std::string_view worst() const {
    return grade == Grade::good ? std::string_view() : reasons.front().message;
  }
};

/// Where marginal and bad begin. "Not in time" is what the controller says in Delay, what had no
/// reply or a late one, and what got lost: in each the controller goes without an answer.
struct VerdictLimits {
  /// Telegrams in a row not in time: half of 10, the Timeout at which the controller stops unless
  /// its ETHERNET object says otherwise. A single one is marginal: with HOLDON="0" and absolute
  /// corrections it can stop the robot.
  static constexpr std::int64_t kBadRun = 5;
  /// Share of telegrams not in time, lost or malformed: 1 % of them at random is a row of five once
  /// in 10^10, but no wired link of a cell has so many. Our choice.
  static constexpr double kBadShare = 0.01;
  /// Of a cycle, for the reply: KR C2's fast cycle takes 12 ms and wants its answer within 2 to
  /// 10 ms; the way to the controller needs its part. Marginal from there at 99.9 %, bad at 50 %.
  static constexpr double kLatencyShare = 0.5;
  /// Of a cycle, for the jitter: what comes late leaves as much less time for the reply. Marginal
  /// at 99.9 %. Bad where 99 % are not within a whole cycle: telegrams then come in bunches. Our
  /// choice.
  static constexpr double kJitterShare = 0.5;
  /// Changes back to the sender before, from where two stream at once: a controller that RSI starts
  /// again sends from a port that it rarely had last but one. Our choice.
  static constexpr std::uint64_t kAlternations = 8;
  /// Telegrams that tell what comes once in 1000. Of fewer, the verdict says how few they are.
  static constexpr std::uint64_t kTelling = 1000;
};

[[nodiscard]] Verdict verdict(const LinkReport& report);

/// Why a telegram is not answered on purpose, and what to do.
inline constexpr const char* kBegunBefore =
    "the stream had begun before sweepd listened, perhaps with another server, and zeros might "
    "move the robot: switch RSI off, and on again after a second or more";

/// What to do where datagrams hold no whole telegram.
inline constexpr const char* kNoWholeTelegram =
    "see whether another program on the controller's address uses this port, and whether the "
    "capture was cut (tcpdump -s 0)";

/// What is wrong where two controllers streamed at once, and what to do; empty where they did not.
[[nodiscard]] std::string text_of_two_senders(const LinkCounts& link);

}  // namespace rsi
