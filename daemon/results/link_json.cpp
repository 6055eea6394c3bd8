#include <chrono>

#include <nlohmann/json.hpp>

#include "daemon/results/link_files.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "daemon/text/utc.hpp"
#include "rsi/link/link_verdict.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using rsi::LinkReport;
using std::chrono::nanoseconds;

double s(nanoseconds time) {
  return rounded(static_cast<double>(time.count()) / 1e9, 6);
}

Json histogram(const rsi::LatencyHistogram& histogram) {
  Json json = {{"count", histogram.count()},
               {"p50_us", us(histogram.quantile(0.5))},
               {"p90_us", us(histogram.quantile(0.9))},
               {"p99_us", us(histogram.quantile(0.99))},
               {"p99_9_us", us(histogram.quantile(0.999))},
               {"max_us", us(histogram.max())},
               {"histogram", Json::array()}};
  for (const LinkBin& bin : link_bins(histogram))
    json["histogram"].push_back(
        {{"above_us", us(bin.from)}, {"to_us", us(bin.to)}, {"count", bin.count}});
  return json;
}

template <typename Amount>
Json places(const rsi::WorstPlaces& worst, const char* name, const Amount& amount) {
  Json json = Json::array();
  for (const rsi::Place& place : worst.places())
    json.push_back({{name, amount(place.amount)}, {"at_s", s(place.at)}, {"ipoc", place.ipoc}});
  return json;
}

Json count_places(const rsi::WorstPlaces& worst, const char* name) {
  return places(worst, name, [](std::int64_t amount) { return amount; });
}

Json verdict_reasons(const rsi::Verdict& verdict) {
  Json json = Json::array();
  for (const rsi::Reason& reason : verdict.reasons)
    json.push_back(
        {{"grade", rsi::text(reason.grade)}, {"code", reason.code}, {"message", reason.message}});
  return json;
}

Json telegrams_json(const LinkReport& report) {
  const rsi::LinkCounts& link = report.link;
  Json json = {{"received", link.telegrams},
               {"lost", link.lost},
               {"duplicated", link.duplicated},
               {"reordered", link.reordered},
               {"malformed", report.malformed},
               {"unanswerable", report.unanswerable},
               {"restarts", link.restarts},
               {"late_replies", nullptr},
               {"late_runs", nullptr},
               {"longest_late_run", nullptr},
               {"has_delay", link.late_replies.has_value()}};
  if (link.late_replies) {
    json["late_replies"] = *link.late_replies;
    json["late_runs"] = link.late_runs;
    json["longest_late_run"] = link.longest_late_run;
  }
  if (report.longest_gap.amount > 0)
    json["longest_gap"] = {{"telegrams", report.longest_gap.amount},
                           {"at_s", s(report.longest_gap.at)},
                           {"ipoc", report.longest_gap.ipoc}};
  json["worst_late_runs"] = count_places(report.late_runs, "replies");
  if (report.missed_by_tap > 0) json["missed_by_tap"] = report.missed_by_tap;
  if (report.queue_full > 0) json["queue_full"] = report.queue_full;
  return json;
}

Json replies_json(const LinkReport& report) {
  const rsi::ReplyCounts& replies = report.replies;
  return {{"sent", replies.sent},
          {"send_failures", replies.failed},
          {"in_time", replies.in_time},
          {"late", replies.late},
          {"superseded", replies.superseded},
          {"unanswered", replies.unanswered},
          {"withheld", replies.withheld},
          {"untimed", replies.untimed},
          {"repeated", replies.repeated},
          {"stray", replies.stray},
          {"worst_runs_not_in_time", count_places(report.silent_runs, "telegrams")}};
}

/// The next of 1, 2, 5, 10, 20, 50, …; the longest duration where a number would be too large.
nanoseconds next_limit(nanoseconds limit, int index) {
  if (limit > nanoseconds::max() / 5) return nanoseconds::max();
  return index % 3 == 1 ? limit * 5 / 2 : limit * 2;
}

}  // namespace

std::string link_json_begins() {
  return std::string("{\n  \"schema\": \"") + schemas::kLink + '"';
}

std::string link_json(const rsi::Conversation& conversation, const LinkReport& report) {
  const rsi::Verdict verdict = rsi::verdict(report);
  Json json = {{"schema", schemas::kLink},
               {"controller", rsi::address_text(conversation.controller)},
               {"server", rsi::text(conversation.sweepd)},
               {"start", utc_text(report.start)},
               {"duration_s", s(report.duration)},
               {"verdict", rsi::text(verdict.grade)},
               {"reasons", verdict_reasons(verdict)}};
  if (report.from_recording) json["from_recording"] = true;
  if (report.step) {
    if (report.cycle > nanoseconds(0)) json["cycle_ms"] = rounded(ms(report.cycle), 3);
    json["ipoc_step"] = *report.step;
    json["ipoc_counts_ms"] = report.ipoc_counts_ms;
  }
  json["telegrams"] = telegrams_json(report);
  if (report.jitter.count() > 0) {
    json["jitter"] = histogram(report.jitter);
    json["jitter"]["earliest_us"] = us(report.earliest);
    json["jitter"]["latest_us"] = us(report.latest);
  }
  if (report.replies.sent + report.replies.failed + report.replies.withheld > 0)
    json["replies"] = replies_json(report);
  if (report.replies.sent > 0) {
    json["latency"] = histogram(report.latency);
    json["latency"]["slowest"] = places(
        report.slowest, "latency_us", [](std::int64_t amount) { return us(nanoseconds(amount)); });
  }
  json["clock_steps"] = {{"count", report.clock_steps},
                         {"back", report.clock_steps_back},
                         {"largest_s", s(report.largest_clock_step)}};
  return json.dump(2) + "\n";
}

std::vector<LinkBin> link_bins(const rsi::LatencyHistogram& histogram) {
  std::vector<LinkBin> bins;
  std::uint64_t below = 0;
  nanoseconds from{};
  nanoseconds to = std::chrono::microseconds(1);
  for (int index = 0; below < histogram.count(); ++index) {
    const auto until = histogram.at_most(to);
    if (until > 0) bins.push_back({from, to, until - below});
    below = until;
    from = to;
    to = next_limit(to, index);
  }
  return bins;
}

}  // namespace sweepd
