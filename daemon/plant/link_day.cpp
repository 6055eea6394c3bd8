#include "daemon/plant/link_day.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/report/file_parts.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kOfTelegrams = 5;  ///< the first of the columns, the others are of replies

std::int64_t count_of(const nlohmann::ordered_json& json, std::string_view key) {
  const double number = number_of(json, std::string(key));
  return std::isfinite(number) && number > 0 && number < 9e15 ? std::llround(number) : 0;
}

bool is_day(const std::string& day) {
  constexpr std::string_view kForm = "dddd-dd-dd";
  return day.size() == kForm.size() &&
         std::equal(day.begin(), day.end(), kForm.begin(), [](char c, char form) {
           return form == '-' ? c == '-' : c >= '0' && c <= '9';
         });
}

}  // namespace

std::optional<ToldLink> link_told(const nlohmann::ordered_json& state) {
  const auto& robots = list_of(state, "robots");
  ToldLink told;
  told.at = text_of(state, "at");
  told.day = told.at.substr(0, 10);
  told.counters.started = text_of(state, "started");
  if (robots.empty() || !is_day(told.day) || told.counters.started.empty()) return std::nullopt;
  const auto& robot = robots.front();
  for (std::size_t i = 0; i < kLinkColumns.size(); ++i)
    told.counters.counts[i] =
        count_of(part_of(robot, i < kOfTelegrams ? "telegrams" : "replies"), kLinkColumns[i]);
  const auto& stream = part_of(robot, "stream");
  const double latency = number_of(part_of(stream, "reply_latency"), "max_us");
  const std::string since = text_of(stream, "since").substr(0, told.day.size());
  if (latency > 0 && std::isfinite(latency) && is_day(since)) {
    told.max_latency_us = latency;
    told.stream_since = since;
  }
  return told;
}

std::optional<LinkCounters> counted_since(const std::optional<LinkCounters>& before,
                                          const ToldLink& told) {
  const LinkCounters& now = told.counters;
  // UTC as ISO 8601: an earlier time is a smaller text.
  if (before && now.started < before->started && before->started <= told.at) return std::nullopt;
  LinkCounters counted = now;
  if (!before || before->started != now.started) return counted;
  bool more = false;
  for (std::size_t i = 0; i < counted.counts.size(); ++i) {
    if (now.counts[i] < before->counts[i]) return std::nullopt;
    counted.counts[i] -= before->counts[i];
    more = more || counted.counts[i] > 0;
  }
  if (!more) return std::nullopt;
  return counted;
}

}  // namespace sweepd
