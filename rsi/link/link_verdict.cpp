#include "rsi/link/link_verdict.hpp"

#include <algorithm>
#include <utility>

#include "rsi/counted.hpp"
#include "rsi/fixed.hpp"
#include "rsi/link/link_remarks.hpp"

namespace rsi {
namespace {

using Limits = VerdictLimits;
using std::chrono::nanoseconds;

std::string ms(nanoseconds time) {
  return fixed(static_cast<double>(time.count()) / 1e6, 2) + " ms";
}

std::string where(const Place& place) {
  return "at " + fixed(static_cast<double>(place.at.count()) / 1e9, 3) + " s, IPOC " +
         std::to_string(place.ipoc);
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

constexpr const char* kBusySender =
    "see what keeps the sender busy, which runs on the same machine";

/// "1 reply (0.01 %)", "12 replies (0.18 %)".
std::string counted_of(std::uint64_t count, std::uint64_t whole, const char* one,
                       const char* many) {
  const double percent = 100 * share(count, whole);
  return rsi::counted(count, one, many) + " (" +
         (percent < 0.005 ? "under 0.01" : fixed(percent, 2)) + " %)";
}

nanoseconds part(nanoseconds cycle, double share) {
  return nanoseconds(static_cast<std::int64_t>(static_cast<double>(cycle.count()) * share));
}

class Judge {
 public:
  explicit Judge(const LinkReport& report) : report_(report), cycles_(report.link.telegrams) {}

  Verdict judged() {
    withheld();
    not_sent();
    controllers_delay();
    telegrams_without_reply();
    lost();
    malformed();
    two_senders();
    doubled_and_overtaken();
    wrong_replies();
    latency();
    jitter();
    for (Reason& remark : remarks_on(report_)) verdict_.reasons.push_back(std::move(remark));
    std::stable_sort(verdict_.reasons.begin(), verdict_.reasons.end(),
                     [](const Reason& a, const Reason& b) { return a.grade > b.grade; });
    if (!verdict_.reasons.empty()) verdict_.grade = verdict_.reasons.front().grade;
    return std::move(verdict_);
  }

 private:
  void add(Grade grade, std::string_view code, std::string message) {
    verdict_.reasons.push_back({grade, code, std::move(message)});
  }
  [[nodiscard]] Grade grade(std::uint64_t count, std::int64_t longest) const {
    const bool bad = longest >= Limits::kBadRun || share(count, cycles_) > Limits::kBadShare;
    return bad ? Grade::bad : Grade::marginal;
  }

  void withheld() {
    const auto count = report_.replies.withheld;
    if (count == 0) return;
    add(Grade::bad, "not_begun",
        counted_of(count, cycles_, "telegram", "telegrams") +
            " got no answer on purpose: " + kBegunBefore);
  }

  void not_sent() {
    const auto count = report_.replies.failed;
    if (count == 0) return;
    add(grade(count, 0), "not_sent",
        "the system of this machine refused to send " +
            counted_of(count, cycles_, "reply", "replies") + ": see `ip -s link` and its firewall");
  }

  void controllers_delay() {
    const LinkCounts& link = report_.link;
    const std::uint64_t late = link.late_replies.value_or(0);
    if (late <= report_.replies.withheld) return;
    const auto longest = static_cast<std::int64_t>(link.longest_late_run);
    std::string message = counted_of(late, report_.link.cycles(), "reply", "replies") +
                          " missed the controller's cycle by its own Delay, in " +
                          rsi::counted(link.late_runs, "run");
    if (!report_.late_runs.empty())
      message += ", at most " + std::to_string(longest) + " in a row (" +
                 where(report_.late_runs.worst()) + ")";
    message += ": ";
    const auto here = report_.replies.not_in_time();
    if (report_.replies.failed >= late)
      message += "the system of this machine refused to send them";
    else if (report_.replies.sent == 0 && report_.replies.withheld > 0)
      message += "sweepd gave none, on purpose";
    else if (report_.replies.sent == 0)
      message +=
          "this capture has no replies, so record both directions to see whether the server or "
          "the network is slow";
    else if (here == 0 && link.lost == 0)
      message +=
          report_.same_machine
              ? std::string("all were answered within a cycle of their coming, so ") + kBusySender
              : "all were answered within a cycle of their coming here, so the time went on "
                "the way from or to the controller: cable, switch, other load on its port";
    else if (here >= late)
      message +=
          "the server did not answer these in time; link.txt and `sweepd inspect` list its slowest "
          "replies";
    else
      message +=
          rsi::counted(here, "telegram was", "telegrams were") + " not answered in time here and " +
          std::to_string(link.lost) + " never came; for the rest " +
          (report_.same_machine ? kBusySender
                                : "look at the way from and to the controller: cable, switch");
    add(grade(late, longest), "late_at_controller", std::move(message));
  }

  void telegrams_without_reply() {
    const ReplyCounts& replies = report_.replies;
    const auto count = replies.not_in_time();
    if (count <= std::min(replies.unanswered, report_.unseen() + replies.failed)) return;
    const Place& worst = report_.silent_runs.worst();
    std::string message = counted_of(count, cycles_, "telegram", "telegrams") +
                          " got no reply within a cycle (" + std::to_string(replies.late) +
                          " late, " + std::to_string(replies.superseded) + " superseded, " +
                          std::to_string(replies.unanswered) + " unanswered), at most " +
                          std::to_string(worst.amount) + " in a row (" + where(worst) + "): ";
    // Where this machine is slow, some of the newest ones wait, too; and where the server left them
    // out, they came a cycle apart.
    const bool came_together = count == replies.superseded && report_.latency.count() > 0 &&
                               report_.latency.max() < part(report_.cycle, 0.5) &&
                               report_.longest_superseded < part(report_.cycle, 0.5);
    if (!came_together)
      message +=
          "see what kept the server's machine busy then, run sweepd with realtime scheduling, and "
          "of another server see that it answers each telegram";
    else
      message += std::string("they came together with later ones, which were answered at once: ") +
                 (report_.same_machine
                      ? kBusySender
                      : "see what holds telegrams up at the controller or on the way from it");
    add(grade(count, worst.amount), "not_answered_in_time", std::move(message));
  }

  void lost() {
    constexpr std::int64_t kLongGap = 1000;
    const auto lost = report_.link.lost;
    if (lost <= report_.unseen()) return;
    const auto gap = std::min(report_.longest_gap.amount, static_cast<std::int64_t>(lost));
    std::string message = counted_of(lost, report_.link.cycles(), "telegram", "telegrams") +
                          " never came, at most " + std::to_string(gap) + " in a row";
    if (gap > 0) message += " (" + where(report_.longest_gap) + ")";
    constexpr const char* kBuffer = "receive buffer (`netstat -su`, receive buffer errors)";
    if (report_.same_machine)
      message += std::string(": the sender left them out, or the ") + kBuffer +
                 " was full: see what keeps this machine busy, since both run on it";
    else if (gap >= kLongGap)
      message +=
          ": the cable was out, or this machine was suspended or recorded nothing: check the "
          "cable, and the power settings of this machine";
    else
      message += std::string(": check cable, connectors and switch, and this machine's ") +
                 kBuffer + "; a simulator may have left them out";
    add(grade(lost, gap), "lost", std::move(message));
  }

  void malformed() {
    if (report_.malformed == 0) return;
    const auto all = cycles_ + report_.unanswerable;
    const auto grade =
        share(report_.malformed, all) > Limits::kBadShare ? Grade::bad : Grade::marginal;
    add(grade, "malformed",
        counted_of(report_.malformed, all, "datagram", "datagrams") +
            " held no whole telegram, and " + std::to_string(report_.unanswerable) +
            " of them could not even be answered: " + kNoWholeTelegram);
  }

  void two_senders() {
    std::string message = text_of_two_senders(report_.link);
    if (!message.empty()) add(Grade::bad, "two_senders", std::move(message));
  }

  void doubled_and_overtaken() {
    const LinkCounts& link = report_.link;
    if (link.duplicated > 0)
      add(Grade::marginal, "duplicated",
          counted_of(link.duplicated, cycles_, "telegram", "telegrams") + " came twice: " +
              (report_.same_machine ? "the sender sent them twice"
                                    : "look for a loop in the network") +
              ", or the capture is one of two interfaces at once");
    if (link.reordered > 0)
      add(Grade::marginal, "reordered",
          counted_of(link.reordered, cycles_, "telegram", "telegrams") +
              " came after a later one: " +
              (report_.same_machine ? "the sender sent them so"
                                    : "take out what has two ways to choose from (bonded links, "
                                      "wireless bridges)"));
  }

  void wrong_replies() {
    const ReplyCounts& replies = report_.replies;
    if (replies.stray > report_.unseen())
      add(share(replies.stray, replies.sent) > Limits::kBadShare ? Grade::bad : Grade::marginal,
          "stray_replies",
          counted_of(replies.stray, replies.sent, "reply", "replies") +
              " had an IPOC that no telegram before had: the controller refuses these; correct "
              "the server, unless the capture itself lost telegrams");
    if (replies.repeated > report_.link.duplicated)
      add(Grade::marginal, "repeated_replies",
          counted_of(replies.repeated, replies.sent, "reply", "replies") +
              " repeated one that was sent already: see whether two servers answer this "
              "controller");
  }

  void latency() {
    const LatencyHistogram& latency = report_.latency;
    const auto limit = part(report_.cycle, Limits::kLatencyShare);
    if (report_.cycle == nanoseconds(0) || latency.quantile(0.999) <= limit) return;
    const bool bad = latency.quantile(0.5) > limit;
    add(bad ? Grade::bad : Grade::marginal, "latency",
        std::string(bad ? "half" : "one in 1000") + " of the replies took longer than " +
            ms(latency.quantile(bad ? 0.5 : 0.999)) + " of a cycle of " + ms(report_.cycle) +
            ", the slowest " + ms(latency.max()) + " (" + where(report_.slowest.worst()) +
            "): free the server's machine, give sweepd realtime scheduling and a processor of "
            "its own, switch power saving off");
  }

  void jitter() {
    const LatencyHistogram& jitter = report_.jitter;
    const bool bad = jitter.quantile(0.99) > report_.cycle;
    if (!bad && jitter.quantile(0.999) <= part(report_.cycle, Limits::kJitterShare)) return;
    add(bad ? Grade::bad : Grade::marginal, "jitter",
        std::string(bad ? "one in 100" : "one in 1000") + " of the telegrams came more than " +
            ms(jitter.quantile(bad ? 0.99 : 0.999)) + " too early or too late (cycle " +
            ms(report_.cycle) + "): " +
            (report_.same_machine
                 ? "the sender does not keep the pace: see what keeps this machine busy, since it "
                   "runs here"
                 : "the sender, or the way from it, does not keep the pace; give the robot a "
                   "network card and cable of its own, without other load on the switch; without "
                   "time stamps of the kernel a busy machine here looks like that too"));
  }

  const LinkReport& report_;
  std::uint64_t cycles_;
  Verdict verdict_;
};

}  // namespace

std::string_view text(Grade grade) noexcept {
  switch (grade) {
    case Grade::good:
      return "good";
    case Grade::marginal:
      return "marginal";
    case Grade::bad:
      return "bad";
  }
  return "";
}

std::string text_of_two_senders(const LinkCounts& link) {
  if (link.alternations < Limits::kAlternations) return {};
  const auto& [one, other] = link.alternating;
  return "two senders streamed at once, " + text(one) + " and " + text(other) +
         ", and took turns " + rsi::counted(link.alternations, "time") +
         ": positions of both are mixed here, so give each controller an address and a port of its "
         "own";
}

Verdict verdict(const LinkReport& report) {
  return Judge(report).judged();
}

}  // namespace rsi
