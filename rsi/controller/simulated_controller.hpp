#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "rsi/endpoint.hpp"
#include "rsi/link/latency_histogram.hpp"
#include "rsi/telegram/ethernet_config.hpp"
#include "rsi/telegram/reply.hpp"
#include "rsi/telegram/telegram_writer.hpp"

namespace rsi {

/// What a controller has against a reply.
enum class ReplyFault {
  unasked,       ///< the Ethernet file says ONLYSEND
  wrong_source,  ///< not from where the telegrams go to
  malformed,
  wrong_type,   ///< Type is not SENTYPE
  wrong_ipoc,   ///< of no telegram since RSI started
  late,         ///< its cycle was over
  repeated,     ///< its telegram was answered already
  missing_tag,  ///< a tag of the RECEIVE list is not there
  not_zero,     ///< a value is not zero: the controller obeys it
};
inline constexpr std::size_t kReplyFaults = 9;
[[nodiscard]] std::string_view text(ReplyFault fault) noexcept;

/// By what replies are measured.
enum class ReplyRule {
  controller,  ///< what a controller evidently accepts: tags may be left out, values are any
  sweepd,      ///< what sweepd promises: every tag of the RECEIVE list is there, with a zero
};

/// The RSI of a controller without its robot, socket and clock: what it sends in each cycle and
/// what it makes of the replies. Times are given by the caller, from any one steady clock.
///
/// A reply counts for the cycle of its telegram if it comes from the server, can be read, has the
/// right Type and the telegram's IPOC, and comes before the cycle is over. Tags that are not in the
/// RECEIVE list are passed over. A tag of it that is missing is a remark, or a fault for which the
/// reply is dropped; a value that is not zero is a remark or a fault, and the reply is accepted
/// either way: a controller obeys it. Which of the two is up to ReplyRule.
class SimulatedController {
 public:
  struct Options {
    Endpoint server{};  ///< replies must come from here
    std::chrono::milliseconds cycle = kUsualCycle;
    std::uint64_t first_ipoc = 100'000;
    int precision = kUsualPrecision;  ///< decimals
    std::uint64_t timeout = 100;      ///< it stops after so many unanswered cycles in a row
    ReplyRule rule = ReplyRule::controller;
  };

  struct Counts {
    std::uint64_t telegrams = 0;
    std::uint64_t replies = 0;  ///< datagrams that came in
    std::uint64_t accepted = 0;
    std::uint64_t unanswered = 0;                      ///< cycles without a reply that was accepted
    std::uint64_t longest_unanswered = 0;              ///< in a row
    std::array<std::uint64_t, kReplyFaults> faults{};  ///< a reply may have two: late, not zero
    std::array<std::uint64_t, kReplyFaults> remarks{};  ///< the same where the rule allows it

    [[nodiscard]] std::uint64_t of(ReplyFault fault) const {
      return faults[static_cast<std::size_t>(fault)];
    }
    [[nodiscard]] std::uint64_t remarks_of(ReplyFault fault) const {
      return remarks[static_cast<std::size_t>(fault)];
    }
  };

  /// Throws std::invalid_argument for options that no controller has.
  SimulatedController(const EthernetConfig& config, const Options& options);

  /// Ends the cycle and appends the telegram of the next one to `telegram`; its Delay is the
  /// controller's own. False, and nothing appended, once the controller has stopped.
  [[nodiscard]] bool next_telegram(SignalValues values, std::string& telegram);
  /// Ends the cycle, and lets the next one pass without a telegram: IPOC goes on.
  void skip_cycle();
  /// The time at which this telegram goes out.
  void sent(std::chrono::nanoseconds time) { sent_ = time; }
  void on_reply(std::string_view payload, const Endpoint& source, std::chrono::nanoseconds time);
  /// Ends the last cycle, so that the counts are complete.
  void finish();
  /// RSI is switched off and on again: IPOC starts anew, a stopped controller runs again.
  void restart(std::uint64_t first_ipoc);

  [[nodiscard]] bool stopped() const { return unanswered_ >= timeout_; }
  [[nodiscard]] std::uint64_t ipoc() const { return ipoc_; }
  [[nodiscard]] const Counts& counts() const { return counts_; }
  /// From a telegram to the reply that was accepted.
  [[nodiscard]] const LatencyHistogram& latency() const { return latency_; }
  /// The first fault of all in words, with IPOC and sender; empty while there is none.
  [[nodiscard]] const std::string& first_fault() const { return first_fault_; }
  /// The first of this kind, be it fault or remark.
  [[nodiscard]] const std::string& first_fault(ReplyFault kind) const {
    return first_faults_[static_cast<std::size_t>(kind)];
  }

 private:
  void count(ReplyFault fault, std::string_view subject, std::string_view detail);
  [[nodiscard]] bool allowed(ReplyFault fault) const;

  TelegramWriter writer_;
  ReplyCheck check_;
  std::string sentype_;
  bool only_send_;
  ReplyRule rule_;
  Endpoint server_;
  std::chrono::milliseconds cycle_;
  std::uint64_t timeout_;

  std::uint64_t first_ipoc_;
  std::uint64_t next_ipoc_;
  std::uint64_t ipoc_ = 0;  // of the last telegram
  std::chrono::nanoseconds sent_{0};
  bool awaiting_ = false;         // the last telegram has no reply yet, and its cycle goes on
  bool answered_ = false;         // the last telegram has its reply
  std::uint64_t unanswered_ = 0;  // cycles in a row

  Counts counts_;
  LatencyHistogram latency_;
  std::string first_fault_;
  std::array<std::string, kReplyFaults> first_faults_;
};

}  // namespace rsi
