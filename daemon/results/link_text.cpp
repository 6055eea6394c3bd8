#include <algorithm>
#include <chrono>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/results/link_files.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"
#include "daemon/text/utc.hpp"
#include "rsi/counted.hpp"
#include "rsi/link/link_verdict.hpp"

namespace sweepd {
namespace {

using rsi::LatencyHistogram;
using rsi::LinkReport;
using rsi::WorstPlaces;
using std::chrono::nanoseconds;

constexpr std::size_t kLabel = 24;
constexpr std::size_t kCount = 10;
constexpr std::size_t kIpoc = 22;  // as many digits as 64 bits can have, and two blanks

std::string rounded_seconds(nanoseconds time) {
  return fixed(static_cast<double>(time.count()) / 1e9, 3);
}

/// Microseconds up to 10 ms, then milliseconds, then seconds: "812 µs", "12.0 ms".
std::string duration(nanoseconds time) {
  using namespace std::chrono_literals;
  const auto size = std::chrono::abs(time);
  if (size < 100us) return fixed(us(time), 1) + " µs";
  if (size < 10ms) return fixed(us(time), 0) + " µs";
  if (size < 10s) return fixed(us(time) / 1e3, 1) + " ms";
  return fixed(us(time) / 1e6, 1) + " s";
}
/// Lined up though µ takes two bytes.
std::string column(nanoseconds time, std::size_t width) {
  const std::string text = duration(time);
  return right(text, width + (text.find("µ") == std::string::npos ? 0 : 1));
}

std::string row(std::string label, std::uint64_t count, const std::string& remark = {}) {
  return left(std::move(label), kLabel) + right(std::to_string(count), kCount) +
         (remark.empty() ? "" : "   " + remark) + "\n";
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  if (part == 0 || whole == 0) return {};
  return fixed(100 * static_cast<double>(part) / static_cast<double>(whole), 3) + " %";
}

std::string cycle_remark(const LinkReport& report) {
  if (!report.step) return {};
  if (report.cycle == nanoseconds(0)) return fmt::format("IPOC rises by {}", *report.step);
  return fmt::format("one every {} ms, IPOC rises by {}",
                     fixed(us(report.cycle) / 1e3, report.ipoc_counts_ms ? 0 : 3), *report.step);
}

std::string delay_remark(const LinkReport& report) {
  if (report.link.late_runs == 0) return "by its Delay";
  return fmt::format("by its Delay, in {} of {}{}", rsi::counted(report.link.late_runs, "run"),
                     report.link.late_runs == 1 ? "" : "at most ", report.link.longest_late_run);
}

std::string late_row(const LinkReport& report) {
  constexpr const char* kLate = "  late at controller";
  if (report.link.late_replies) return row(kLate, *report.link.late_replies, delay_remark(report));
  return left(kLate, kLabel) + right("-", kCount) + "   not known: the telegrams carry no Delay\n";
}

std::string telegrams(const LinkReport& report) {
  const rsi::LinkCounts& link = report.link;
  const auto of = [&](std::uint64_t part) { return percent(part, link.telegrams); };
  return row("Telegrams", link.telegrams, cycle_remark(report)) +
         row("  lost", link.lost, percent(link.lost, link.cycles())) +
         (report.missed_by_tap == 0
              ? ""
              : row("  missed by the tap", report.missed_by_tap, "packets of both directions")) +
         (report.queue_full == 0
              ? ""
              : row("  queue full", report.queue_full, "datagrams of both directions")) +
         row("  duplicated", link.duplicated, of(link.duplicated)) +
         row("  reordered", link.reordered, of(link.reordered)) +
         row("  malformed", report.malformed,
             report.unanswerable == 0 ? of(report.malformed)
                                      : fmt::format("{} without an IPOC", report.unanswerable)) +
         row("  restarts of RSI", link.restarts) + late_row(report) +
         (report.clock_steps == 0 ? ""
                                  : row("  clock against IPOC", report.clock_steps,
                                        "by at most " + duration(report.largest_clock_step)));
}

std::string replies(const LinkReport& report) {
  const rsi::ReplyCounts& replies = report.replies;
  if (replies.sent + replies.failed == 0)
    return left("Replies", kLabel) + right("none", kCount) +
           (replies.withheld > 0 ? "   the stream had begun before sweepd listened\n"
                                 : "   ONLYSEND, or only one direction was captured\n");
  const auto all = replies.in_time + replies.not_in_time();
  const auto line = [&](const char* label, std::uint64_t count, const std::string& what) {
    const auto share = percent(count, all);
    return row(label, count, share.empty() ? what : share + ", " + what);
  };
  std::string text = row("Replies", replies.sent) +
                     line("  in time", replies.in_time, "within a cycle") +
                     line("  late", replies.late, "later than a cycle") +
                     line("  superseded", replies.superseded, "a newer telegram was answered") +
                     line("  unanswered", replies.unanswered, "telegrams without any reply");
  if (replies.withheld > 0)
    text += row("  withheld", replies.withheld, "the stream had begun before sweepd listened");
  if (replies.failed > 0) text += row("  not sent", replies.failed, "the system refused them");
  if (replies.untimed > 0)
    text += row("  not timed", replies.untimed, "clock stepped between telegram and reply");
  if (replies.repeated > 0)
    text += row("  repeated", replies.repeated, "to what was answered already");
  if (replies.stray > 0) text += row("  stray", replies.stray, "to no telegram in this capture");
  return text;
}

std::string quantiles(const LinkReport& report) {
  constexpr std::size_t kWidth = 10;
  const auto line = [](const char* label, const LatencyHistogram& histogram) {
    std::string text = left(label, 16);
    for (const double q : {0.5, 0.9, 0.99, 0.999, 1.0})
      text += column(histogram.quantile(q), kWidth);
    return text + "\n";
  };
  std::string text = left("", 16);
  for (const char* head : {"p50", "p90", "p99", "p99.9", "max"}) text += right(head, kWidth);
  text += "\n";
  if (report.latency.count() > 0) text += line("Reply latency", report.latency);
  text += line("Cycle jitter", report.jitter);
  return text + left("", 16) + "earliest " + duration(report.earliest) + ", latest +" +
         duration(report.latest) + "\n";
}

std::string bars(const char* title, const LatencyHistogram& histogram) {
  constexpr std::size_t kLongest = 40;
  const auto bins = link_bins(histogram);
  std::uint64_t most = 0;
  for (const LinkBin& bin : bins) most = std::max(most, bin.count);
  std::string text = std::string(title) + "\n";
  for (const LinkBin& bin : bins) {
    const auto length = (bin.count * kLongest + most - 1) / most;  // one at least, if any
    text += "  up to " + column(bin.to, 9) + right(std::to_string(bin.count), kCount) + "  " +
            std::string(length, '#') + "\n";
  }
  return text;
}

template <typename Amount>
std::string places(const char* title, const char* what, const WorstPlaces& worst,
                   const Amount& amount) {
  std::string text =
      std::string(title) + "\n" + right(what, 12) + right("at s", 14) + right("IPOC", kIpoc) + "\n";
  for (const rsi::Place& place : worst.places())
    text += amount(place.amount) + right(rounded_seconds(place.at), 14) +
            right(std::to_string(place.ipoc), kIpoc) + "\n";
  return text;
}

std::string reasons(const rsi::Verdict& verdict) {
  if (verdict.reasons.empty()) return "  Nothing is wrong with this link.\n";
  std::string text;
  for (const rsi::Reason& reason : verdict.reasons)
    text += paragraph(
        "  " +
            left(reason.grade == rsi::Grade::good ? "note" : std::string(rsi::text(reason.grade)),
                 10),
        reason.message);
  return text;
}

/// "good", and of few telegrams as far as these tell.
std::string grade(const rsi::Verdict& verdict, const LinkReport& report) {
  const bool few = report.link.telegrams < rsi::VerdictLimits::kTelling;
  std::string text(rsi::text(verdict.grade));
  if (few && verdict.grade == rsi::Grade::good)
    text += ", as far as " + rsi::counted(report.link.telegrams, "telegram") + " can tell";
  return text;
}

}  // namespace

std::string link_text(const rsi::Conversation& conversation, const LinkReport& report) {
  const rsi::Verdict verdict = rsi::verdict(report);
  std::string text = "Link of " + rsi::text(conversation) + "\n" +
                     rounded_seconds(report.duration) + " s from " + utc_text(report.start) +
                     "\n\nVerdict: " + grade(verdict, report) + "\n" + reasons(verdict) + "\n" +
                     telegrams(report) + "\n" + replies(report);
  if (report.jitter.count() > 0) text += "\n" + quantiles(report);
  if (report.latency.count() > 0) text += "\n" + bars("Reply latency", report.latency);
  if (report.jitter.count() > 0) text += "\n" + bars("Cycle jitter, early or late", report.jitter);
  const auto time = [](std::int64_t amount) { return column(nanoseconds(amount), 12); };
  const auto count = [](std::int64_t amount) { return right(std::to_string(amount), 12); };
  if (!report.slowest.empty())
    text += "\n" + places("Slowest replies", "latency", report.slowest, time);
  if (!report.silent_runs.empty())
    text += "\n" + places("Telegrams in a row without a reply in time, longest first", "telegrams",
                          report.silent_runs, count);
  if (!report.late_runs.empty())
    text += "\n" + places("Runs of late replies by the controller's Delay, longest first",
                          "replies", report.late_runs, count);
  return text;
}

}  // namespace sweepd
