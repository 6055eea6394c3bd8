#include "daemon/commands/simulation_report.hpp"

#include <algorithm>
#include <numeric>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "daemon/text/numbers.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using rsi::counted;
using rsi::ReplyFault;
using End = rsi::ControllerLink::End;

std::string report_row(std::string_view label, std::string_view value, std::string_view unit = {}) {
  constexpr std::size_t label_width = 24;
  constexpr std::size_t value_width = 10;
  std::string line(label);
  line.append(label_width - std::min(label.size(), label_width), ' ');
  line.append(value_width - std::min(value.size(), value_width), ' ').append(value);
  if (!unit.empty()) line.append(" ").append(unit);
  return line + '\n';
}

std::string report_row(std::string_view label, std::uint64_t count, std::string_view unit = {}) {
  return report_row(label, std::to_string(count), unit);
}

std::string duration_text(std::chrono::milliseconds time) {
  return fixed(std::chrono::duration<double>(time).count(), 1) + " s";
}

/// That were played, with a telegram or without.
std::uint64_t cycles(const SimulationReport& report) {
  return report.link.controller.telegrams + report.link.skipped;
}

std::string_view ending(const SimulationReport& report) {
  if (report.interrupted) return "a signal stopped it";
  if (report.live && report.link.end == End::timed_out)
    return "the controller stopped for want of replies";
  if (report.live && report.link.end == End::disconnected) return "the connection broke";
  if (cycles(report) < report.planned) return "it ended before the plan was over";
  return "the plan was played to its end";
}

std::string reply_rows(const SimulationReport& report) {
  const auto& counts = report.link.controller;
  std::string rows;
  if (report.only_send) {
    rows += report_row("replies", counts.replies, "none expected: ONLYSEND");
  } else {
    rows += report_row("replies accepted", counts.accepted);
    if (const auto count = counts.remarks_of(ReplyFault::missing_tag); count != 0)
      rows += report_row("  with tags left out", count, "which controllers accept");
    if (const auto count = counts.remarks_of(ReplyFault::not_zero); count != 0)
      rows += report_row("  with values not zero", count, "which controllers obey");
    for (const auto& remark : report.link.first_remarks) rows += "  first " + remark + '\n';
    rows += report_row("cycles unanswered", counts.unanswered,
                       fmt::format("at most {} in a row", counts.longest_unanswered));
    rows += report_row("replies late", counts.of(ReplyFault::late));
  }
  bool refused = false;
  for (std::size_t i = 0; i < rsi::kReplyFaults; ++i) {
    const auto kind = static_cast<ReplyFault>(i);
    if (kind == ReplyFault::late || counts.of(kind) == 0) continue;
    // A controller obeys these: they are accepted all the same.
    const bool obeyed = kind == ReplyFault::not_zero;
    rows += report_row(obeyed ? "replies not zero" : "replies refused", counts.of(kind),
                       obeyed ? "sweepd promises zeros" : rsi::text(kind));
    refused = refused || !obeyed;
  }
  if (!refused) rows += report_row("replies refused", 0);
  if (!report.link.first_fault.empty()) rows += "  first " + report.link.first_fault + '\n';
  return rows;
}

std::string latency_rows(const rsi::LatencyHistogram& latency) {
  if (latency.count() == 0) return {};
  const auto microseconds = [](std::string_view label, std::chrono::nanoseconds time,
                               std::string_view of = {}) {
    return report_row(label, fixed(static_cast<double>(time.count()) / 1e3, 1),
                      fmt::format("µs{}", of));
  };
  return microseconds("latency p50", latency.quantile(0.5)) +
         microseconds("latency p99", latency.quantile(0.99)) +
         microseconds("latency p99.9", latency.quantile(0.999)) +
         microseconds("latency max", latency.max(), ", of replies in time");
}

std::uint64_t beyond(std::uint64_t count, std::uint64_t excused) {
  return count > excused ? count - excused : 0;
}

std::string link_problem(const SimulationReport& report) {
  const auto& link = report.link;
  const auto& counts = link.controller;
  if (link.end == End::disconnected)
    return "the connection to " + report.target + " broke: " + link.disconnection +
           ": see what became of the server, and run it again: RSI over TCP has to be started anew";

  if (link.send_failures != 0)
    return counted(link.send_failures, "datagram", "datagrams") + " could not be sent to " +
           report.target + ": " + link.first_send_failure +
           ": check the address and this machine's network";

  if (counts.replies == 0 && counts.unanswered > link.wire.lost)
    return "nobody answered at " + report.target +
           ": start `sweepd run` there, or check address and port";

  const std::uint64_t held_back = link.wire.swapped + (report.swaps ? 1 : 0);
  const auto all = std::accumulate(counts.faults.begin(), counts.faults.end(), std::uint64_t{0});
  const auto refused = all - counts.of(ReplyFault::late) -
                       std::min(counts.of(ReplyFault::repeated), link.wire.duplicated);
  const auto late = beyond(counts.of(ReplyFault::late), held_back);
  const auto first = " (the first fault: " + link.first_fault + "): ";
  if (refused != 0)
    return counted(refused, "reply was refused", "replies were refused") +
           (late != 0 ? " and " + counted(late, "was late", "were late") : "") + first +
           "correct the server";
  if (late != 0)
    return counted(late, "reply was late", "replies were late") + first +
           "see what keeps the server or this machine busy";

  const auto missing = beyond(counts.unanswered, link.wire.lost + 2 * held_back);
  if (missing != 0 || link.end == End::timed_out)
    return counted(missing != 0 ? missing : counts.longest_unanswered, "cycle was", "cycles were") +
           " not answered by " + report.target +
           ": see whether it was stopped, and what keeps it busy";
  return {};
}

}  // namespace

std::string text(const SimulationReport& report) {
  const auto& link = report.link;
  const auto telegrams = link.controller.telegrams;
  std::string text = fmt::format("Simulated {} {}, {} of {}: {}.\n", report.live ? "to" : "into",
                                 report.target, duration_text(cycles(report) * report.cycle),
                                 duration_text(report.planned * report.cycle), ending(report));
  text += report_row("telegrams", telegrams, fmt::format("one every {} ms", report.cycle.count()));
  text += report_row("  lost on purpose", link.wire.lost);
  text += report_row("  duplicated on purpose", link.wire.duplicated);
  text += report_row("  swapped on purpose", link.wire.swapped, "pairs");
  if (!report.live) return text;
  if (link.skipped != 0)
    text +=
        report_row("cycles overslept", link.skipped, "by this machine: no telegrams, IPOC went on");
  if (link.send_failures != 0)
    text +=
        report_row("datagrams not sent", link.send_failures, "first: " + link.first_send_failure);
  return text + reply_rows(report) + latency_rows(link.latency);
}

std::string problem(const SimulationReport& report) {
  if (report.live)
    if (auto text = link_problem(report); !text.empty()) return text;
  if (report.interrupted)
    return "a signal stopped the simulation before the plan was over" +
           (report.live ? "" : ", and " + report.target + " is not written") + ": run it again";
  return {};
}

bool only_late(const SimulationReport& report) {
  const auto& counts = report.link.controller;
  const auto timely = counts.of(ReplyFault::late) +
                      std::min(counts.of(ReplyFault::repeated), report.link.wire.duplicated);
  return report.live && !report.interrupted && report.link.end == End::done &&
         report.link.send_failures == 0 && counts.replies > 0 &&
         timely == std::accumulate(counts.faults.begin(), counts.faults.end(), std::uint64_t{0});
}

}  // namespace sweepd
