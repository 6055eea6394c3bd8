#include "rsi/link_verdict.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace rsi {
namespace {

using Limits = VerdictLimits;
using std::chrono::nanoseconds;

std::string fixed(double value, int decimals) {
  std::array<char, 400> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                 std::chars_format::fixed, decimals);
  return {digits.data(), end.ptr};
}

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

/// "1 reply (0.01 %)", "12 replies (0.18 %)".
std::string counted(std::uint64_t count, std::uint64_t whole, const char* one, const char* many) {
  const double percent = 100 * share(count, whole);
  return std::to_string(count) + ' ' + (count == 1 ? one : many) + " (" +
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
    controllers_delay();
    telegrams_without_reply();
    lost();
    malformed();
    doubled_and_overtaken();
    wrong_replies();
    latency();
    jitter();
    good_to_know();
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
        counted(count, cycles_, "telegram", "telegrams") +
            " got no answer on purpose: this stream had begun before sweepd listened, perhaps "
            "with another server, and zeros might have moved the robot: switch RSI off, and on "
            "again after a second or more");
  }

  void controllers_delay() {
    const LinkCounts& link = report_.link;
    if (link.late_replies <= report_.replies.withheld) return;
    const auto longest = static_cast<std::int64_t>(link.longest_late_run);
    std::string message = counted(link.late_replies, cycles_, "reply", "replies") +
                          " missed the controller's cycle by its own Delay, in " +
                          std::to_string(link.late_runs) + (link.late_runs == 1 ? " run" : " runs");
    if (!report_.late_runs.empty())
      message += ", at most " + std::to_string(longest) + " in a row (" +
                 where(report_.late_runs.worst()) + ")";
    message += ": ";
    const auto here = report_.replies.not_in_time();
    if (report_.replies.sent == 0)
      message +=
          "this capture has no replies, so record both directions to see whether the server or "
          "the network is slow";
    else if (here == 0 && link.lost == 0)
      message +=
          "all were answered in time here, so look at the way back to the controller: cable, "
          "switch, other load on its port";
    else if (here >= link.late_replies)
      message += "the server did not answer these in time, see below";
    else
      message += std::to_string(here) + " telegrams were not answered in time here and " +
                 std::to_string(link.lost) +
                 " got lost, the rest of it is on the way back to the controller: cable, switch";
    add(grade(link.late_replies, longest), "late_at_controller", std::move(message));
  }

  void telegrams_without_reply() {
    const ReplyCounts& replies = report_.replies;
    const auto count = replies.not_in_time();
    if (count == 0) return;
    const Place& worst = report_.silent_runs.worst();
    std::string message = counted(count, cycles_, "telegram", "telegrams") +
                          " got no reply within a cycle (" + std::to_string(replies.late) +
                          " late, " + std::to_string(replies.superseded) + " superseded, " +
                          std::to_string(replies.unanswered) + " unanswered), at most " +
                          std::to_string(worst.amount) + " in a row (" + where(worst) +
                          "): see what kept the server's machine busy then, and run sweepd with "
                          "realtime scheduling";
    add(grade(count, worst.amount), "not_answered_in_time", std::move(message));
  }

  void lost() {
    const auto lost = report_.link.lost;
    if (lost == 0) return;
    const auto gap = std::min(report_.longest_gap.amount, static_cast<std::int64_t>(lost));
    std::string message = counted(lost, cycles_ + lost, "telegram", "telegrams") +
                          " never came, at most " + std::to_string(gap) + " in a row";
    if (gap > 0) message += " (" + where(report_.longest_gap) + ")";
    message += gap >= 1000
                   ? ": the cable was out, or this machine was suspended or recorded nothing"
                   : ": check cable, connectors and switch, and the receive buffer of this machine "
                     "(`netstat -su`, receive buffer errors)";
    add(grade(lost, gap), "lost", std::move(message));
  }

  void malformed() {
    if (report_.malformed == 0) return;
    const auto all = cycles_ + report_.unanswerable;
    const auto grade =
        share(report_.malformed, all) > Limits::kBadShare ? Grade::bad : Grade::marginal;
    add(grade, "malformed",
        counted(report_.malformed, all, "datagram", "datagrams") + " held no whole telegram, and " +
            std::to_string(report_.unanswerable) +
            " of them could not even be answered: see whether another program on the "
            "controller's address uses this port, and whether the capture was cut (tcpdump -s 0)");
  }

  void doubled_and_overtaken() {
    const LinkCounts& link = report_.link;
    if (link.duplicated > 0)
      add(Grade::marginal, "duplicated",
          counted(link.duplicated, cycles_, "telegram", "telegrams") +
              " came twice: look for a loop in the network, or a capture of two interfaces at "
              "once");
    if (link.reordered > 0)
      add(Grade::marginal, "reordered",
          counted(link.reordered, cycles_, "telegram", "telegrams") +
              " came after a later one: take out what has two ways to choose from (bonded "
              "links, wireless bridges)");
  }

  void wrong_replies() {
    const ReplyCounts& replies = report_.replies;
    if (replies.stray > 0)
      add(share(replies.stray, replies.sent) > Limits::kBadShare ? Grade::bad : Grade::marginal,
          "stray_replies",
          counted(replies.stray, replies.sent, "reply", "replies") +
              " had an IPOC that no telegram before had: the controller refuses these; correct "
              "the server, unless the capture itself lost telegrams");
    if (replies.repeated > report_.link.duplicated)
      add(Grade::marginal, "repeated_replies",
          counted(replies.repeated, replies.sent, "reply", "replies") +
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
            ms(report_.cycle) +
            "): the sender, or the way from it, does not keep the pace; give the robot a network "
            "card and cable of its own, without other load on the switch; without time stamps of "
            "the kernel a busy machine here looks like that too");
  }

  void good_to_know() {
    const LinkCounts& link = report_.link;
    if (link.restarts > 0)
      add(Grade::good, "restarts",
          "RSI began anew " + std::to_string(link.restarts) +
              (link.restarts == 1 ? " time" : " times") +
              ": if no program on the controller did that, look there for why it stopped");
    if (report_.clock_steps > 0)
      add(Grade::good, "clock_steps",
          "the clock of the machine was set " + std::to_string(report_.clock_steps) +
              (report_.clock_steps == 1 ? " time" : " times") + ", by at most " +
              fixed(static_cast<double>(report_.largest_clock_step.count()) / 1e9, 3) +
              " s: replies around it are not timed; let chrony slew the clock instead");
    if (report_.replies.sent > 0 && !report_.has_delay)
      add(Grade::good, "no_delay",
          "the telegrams carry no Delay, so what reached the controller too late cannot be seen: "
          "add DEF_Delay to SEND in its Ethernet file");
    if (!report_.ipoc_counts_ms)
      add(Grade::good, "ipoc_no_clock",
          "the IPOC does not count milliseconds of this machine's clock: a simulator, or a "
          "capture that was not made in real time; the cycle is the median time between telegrams");
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

Verdict verdict(const LinkReport& report) {
  return Judge(report).judged();
}

}  // namespace rsi
