#include "daemon/history/campaign_record.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "daemon/record/session_folder.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/utc.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

/// A folder may be named by its start as the daemon's are, or begin with a date.
std::optional<std::chrono::nanoseconds> time_in(const std::string& name) {
  const std::string last = std::filesystem::path(name).filename().string();
  if (const auto session = session_name(last)) return parse_utc(session->first);
  constexpr std::size_t kDate = 10;
  if (last.size() < kDate || last[4] != '-' || last[7] != '-') return std::nullopt;
  return parse_utc(std::string_view(last).substr(0, kDate));
}

void set_time(CampaignRecord& record, const CampaignTexts& texts, const Json& link) {
  for (const CampaignNote& note : record.notes)
    if (note.measured) {
      record.time = note.time;
      record.time_from = "note";
    }
  if (!record.time_from.empty()) return;
  const auto take = [&](const std::optional<std::chrono::nanoseconds>& time, const char* from) {
    if (!time || !record.time_from.empty()) return;
    record.time = *time;
    record.time_from = from;
  };
  const Json run = Json::parse(texts.run, nullptr, false);
  take(parse_utc(text_of(run, "started")), file_names::kRun);
  take(parse_utc(text_of(link, "start")), file_names::kLink);
  take(time_in(texts.name), "name");
  take(texts.written, "age");
}

/// Half the difference of the two directions, where a place was passed in both.
std::vector<JointFriction> friction_in(std::string_view csv) {
  struct Sum {
    double count = 0, sum = 0, squares = 0;
  };
  std::map<std::size_t, Sum> sums;
  Cells cells;
  for (static_cast<void>(take_line(csv)); !csv.empty();) {
    cells.split(take_line(csv));
    const double joint = value_in(cells[0]);
    const double half = (value_in(cells[2]) - value_in(cells[3])) / 2;
    if (!(joint >= 1 && joint < 64) || !std::isfinite(half)) continue;
    Sum& sum = sums[static_cast<std::size_t>(joint) - 1];
    ++sum.count;
    sum.sum += half;
    sum.squares += half * half;
  }
  std::vector<JointFriction> all;
  for (const auto& [joint, sum] : sums) {
    const double mean = sum.sum / sum.count;
    all.push_back({joint, std::abs(mean),
                   std::sqrt(std::max(0.0, sum.squares / sum.count - mean * mean)), kNothing});
  }
  return all;
}

std::vector<JointFriction> friction_of(const Json& result, std::string_view currents_csv) {
  std::vector<JointFriction> all;
  for (const Json& joint : list_of(result, "currents")) {
    const double number = number_of(joint, "joint");
    const double friction = number_of(joint, "friction_a");
    if (!(number >= 1 && number < 64) || !std::isfinite(friction)) continue;
    all.push_back({static_cast<std::size_t>(number) - 1, friction, number_of(joint, "scatter_a"),
                   number_of(joint, "speed_deg_s")});
  }
  return all.empty() ? friction_in(currents_csv) : all;
}

std::optional<LinkQuality> link_of(const Json& json) {
  if (text_of(json, "schema") != schemas::kLink) return std::nullopt;
  const Json& telegrams = part_of(json, "telegrams");
  return LinkQuality{text_of(json, "verdict"),
                     number_of(telegrams, "received"),
                     number_of(telegrams, "lost"),
                     number_of(telegrams, "late_replies"),
                     number_of(part_of(json, "latency"), "p99_9_us"),
                     number_of(part_of(json, "jitter"), "p99_9_us")};
}

}  // namespace

std::string CampaignRecord::same_state() const {
  std::string state;
  for (const CampaignNote& note : notes)
    if (note.same_state) state = *note.same_state;
  return state;
}

CampaignRecord campaign_record(const CampaignTexts& texts) {
  CampaignRecord record;
  record.name = texts.name;
  CampaignNotes notes = parse_notes(texts.notes);
  record.notes = std::move(notes.notes);
  record.broken_notes = std::move(notes.broken_lines);
  const Json link = Json::parse(texts.link, nullptr, false);
  record.link = link_of(link);
  set_time(record, texts, link);
  if (!texts.problem.empty()) {
    record.why_not = (std::filesystem::path(texts.name) / file_names::kResult).string() +
                     " cannot be read (" + texts.problem + "): check its permissions";
    return record;
  }
  if (texts.result.empty()) {
    record.why_not = texts.name + " has no result.json: it is half deleted, or not written yet";
    return record;
  }
  const auto file = std::filesystem::path(texts.name) / file_names::kResult;
  try {
    const Json result = parse_result(file, texts.result);
    record.friction = friction_of(result, texts.currents);
    record.arm = told_arm_in(result, file);
  } catch (const std::exception& problem) {
    record.why_not = problem.what();
  }
  return record;
}

}  // namespace sweepd
