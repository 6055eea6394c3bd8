#include "rsi/link/link_remarks.hpp"

#include <utility>

#include "rsi/counted.hpp"
#include "rsi/fixed.hpp"

namespace rsi {
namespace {

class Remarks {
 public:
  explicit Remarks(const LinkReport& report) : report_(report) {}

  std::vector<Reason> told() {
    not_seen();
    from_recording();
    good_to_know();
    return std::move(remarks_);
  }

 private:
  void add(std::string_view code, std::string message) {
    remarks_.push_back({Grade::good, code, std::move(message)});
  }

  void not_seen() {
    const std::string on_the_link =
        "as many of what counts as lost, unanswered or stray here were well on the link";
    if (const auto missed = report_.missed_by_tap; missed > 0)
      add("missed_by_tap",
          counted(missed, "packet", "packets") +
              " passed the tap unseen, as its machine was too busy: " + on_the_link);
    if (const auto missed = report_.queue_full; missed > 0)
      add("queue_full", counted(missed, "datagram was", "datagrams were") +
                            " neither counted here nor recorded, as sweepd's queue was full: " +
                            on_the_link + "; raise `queue_bytes`, or free this machine");
  }

  void from_recording() {
    if (!report_.from_recording) return;
    add("from_recording",
        "sweepd was cut off in this session, and its recording alone tells of the link: telegrams "
        "that got no answer on purpose count as unanswered here, and what a tap or the recording "
        "missed counts as lost or unanswered; how the stream ended is not known");
  }

  void good_to_know() {
    const LinkCounts& link = report_.link;
    const auto cycles = link.telegrams;
    if (cycles > 0 && cycles < VerdictLimits::kTelling)
      add("few_telegrams", counted(cycles, "telegram is", "telegrams are") +
                               " too few to judge a link by: what comes once in " +
                               std::to_string(VerdictLimits::kTelling) +
                               " need not be among them; record a minute or more");
    const ReplyCounts& replies = report_.replies;
    const bool told = link.late_replies.value_or(0) > 0;  // with them
    if (cycles > 0 && !told && replies.sent + replies.failed + replies.withheld == 0)
      add("no_replies",
          std::string("no reply was seen: ") +
              (report_.from_recording
                   ? "unless the controller wants none (ONLYSEND), sweepd gave none on purpose, as "
                     "to a stream that had begun before it listened"
                   : "unless the controller wants none (ONLYSEND), nothing is known of what it "
                     "got; record both directions"));
    if (link.restarts > 0 && link.alternations < VerdictLimits::kAlternations)
      add("restarts",
          "RSI began anew " + counted(link.restarts, "time") +
              ": if no program on the controller did that, look there for why it stopped");
    if (link.missed_before > 0)
      add("missed_before",
          "the controller had missed " + counted(link.missed_before, "reply", "replies") +
              " before the first telegram that was seen: nobody answered until then");
    if (report_.clock_steps > 0) clock_steps();
    // Of what was not read nobody knows whether it carries one.
    const auto all = cycles + report_.unanswerable;
    const bool read = all == 0 || 2 * report_.malformed < all;
    if (read && report_.replies.sent > 0 && !link.late_replies)
      add("no_delay",
          "the telegrams carry no Delay, so what reached the controller too late cannot be seen: "
          "add DEF_Delay to SEND in its Ethernet file");
    if (!report_.ipoc_counts_ms)
      add("ipoc_no_clock",
          "the IPOC does not count milliseconds of this machine's clock: a simulator, or a "
          "capture that was not made in real time; the cycle is the median time between telegrams");
  }

  /// A clock that goes back was set. Of one that runs ahead of the IPOC nothing tells whether it
  /// was set, or the sender paused.
  void clock_steps() {
    const auto ahead = report_.clock_steps - report_.clock_steps_back;
    const std::string size =
        fixed(static_cast<double>(report_.largest_clock_step.count()) / 1e9, 3) + " s";
    std::string message;
    if (report_.clock_steps_back > 0)
      message = "the clock of the machine was set back " +
                counted(report_.clock_steps_back, "time") + " (let chrony slew it instead)" +
                (ahead > 0 ? ", and " : "");
    if (ahead > 0)
      message += counted(ahead, "time") +
                 " the clock of the machine ran ahead of the IPOC and stayed there: it was set, or "
                 "the sender paused with its IPOC (a simulator, a machine that was suspended)";
    add("clock_steps", message + "; by at most " + size + ", and replies around it are not timed");
  }

  const LinkReport& report_;
  std::vector<Reason> remarks_;
};

}  // namespace

std::vector<Reason> remarks_on(const LinkReport& report) {
  return Remarks(report).told();
}

}  // namespace rsi
