#include "daemon/results/run_json.hpp"

#include <fstream>

#include <nlohmann/json.hpp>

#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/json_text.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Recording::Counts& counts) {
  Json recording = {
      {"files", counts.files},
      {"bytes", counts.bytes},
      {"datagrams", counts.recorded.datagrams},
      {"samples", counts.recorded.samples},
      {"not_recorded",
       {{"memory_full", records_json(counts.memory_full)}, {"disk", records_json(counts.disk)}}},
      {"paused", counts.pauses}};
  if (counts.folders_deleted > 0) {
    recording["folders_deleted"] = counts.folders_deleted;
    recording["deleted"] = records_json(counts.deleted);
  }
  if (counts.files_deleted > 0) recording["files_deleted"] = counts.files_deleted;
  return recording;
}

Json json(const std::vector<FileHash>& inputs) {
  Json list = Json::array();
  for (const FileHash& input : inputs)
    list.push_back(
        {{"file", input.file.string()}, {"bytes", input.bytes}, {"sha256", input.sha256}});
  return list;
}

constexpr const char* kRecordingPaused = "recording_paused";
constexpr const char* kRecordingDeleted = "recording_deleted";

/// Of `folder`, as far as it can be read.
Json run_in(const std::filesystem::path& folder) {
  std::ifstream stream(folder / file_names::kRun, std::ios::binary);
  return Json::parse(stream, nullptr, false);
}

Json begun(std::string_view command) {
  return {{"schema", schemas::kRun}, {"sweepd", SWEEPD_VERSION}, {"command", command}};
}

}  // namespace

Json records_json(const RecordCount& count) {
  return {{"datagrams", count.datagrams}, {"samples", count.samples}};
}

std::string run_json(const RunFacts& facts) {
  const bool watched = !facts.watched_on.empty();
  Json run = begun(watched ? "watch" : "run");
  run["robot"] = facts.robot;
  run["started"] = facts.started;
  if (!facts.ended.empty()) run["ended"] = facts.ended;
  run["folder"] = facts.folder.string();
  if (!facts.description.empty()) run["description"] = facts.description.string();
  if (facts.ethernet_config) run["ethernet_config"] = facts.ethernet_config->string();
  if (!facts.inputs.empty()) run["inputs"] = json(facts.inputs);
  run["listen"] = rsi::text(facts.listen);
  if (watched)
    run["watched"] = {{"interface", facts.watched_on},
                      {"missed", facts.link.missed},
                      {"copies", facts.link.copies}};
  run["since_start_of_sweepd"] = {{"answered", facts.link.answered},
                                  {"superseded", facts.link.superseded},
                                  {"unanswerable", facts.link.unanswerable},
                                  {"foreign", facts.link.foreign},
                                  {"not_begun", facts.link.not_begun},
                                  {"refused", facts.link.refused},
                                  {"cut", facts.link.cut},
                                  {"send_failures", facts.link.send_failures},
                                  {"dropped", facts.link.dropped},
                                  {"skipped_bytes", facts.link.skipped},
                                  {"overflows", facts.link.overflows}};
  if (facts.recording) {
    run["recording"] = json(*facts.recording);
    run["recording"]["not_recorded"]["queue_full"] = {{"datagrams", facts.queue_full}};
  }
  if (facts.ended.empty()) run[kRecordingPaused] = false;
  return json_text(run);
}

std::string run_json(std::string_view command, const Json& given,
                     const std::vector<std::string>& arguments,
                     const std::vector<FileHash>& inputs) {
  Json run = begun(command);
  run.update(given);
  if (!arguments.empty()) run["arguments"] = arguments;
  if (!inputs.empty()) run["inputs"] = json(inputs);
  return json_text(run);
}

std::string run_json_of_cut_session(const std::filesystem::path& folder, const CutSession& cut) {
  Json run = run_in(folder);
  if (!run.is_object()) run = begun("run");
  run["ended"] = cut.ended;
  run.erase("since_start_of_sweepd");
  if (const auto watched = run.find("watched"); watched != run.end() && watched->is_object()) {
    watched->erase("missed");
    watched->erase("copies");
  }
  if (run.value(kRecordingPaused, Json()) == false) run.erase(kRecordingPaused);
  if (cut.made_of) {
    run["from_recording"] = true;
    run["recovered"] = {{"sweepd", SWEEPD_VERSION}, {"inputs", json(*cut.made_of)}};
  }
  if (!cut.damage.empty()) run["damage"] = cut.damage;
  return json_text(run);
}

void mark_recording_paused(const std::filesystem::path& folder) {
  constexpr std::string_view kNo = R"("recording_paused": false)";
  constexpr std::string_view kYes = R"("recording_paused": true )";
  static_assert(kNo.size() == kYes.size());
  const auto path = folder / file_names::kRun;
  const auto at = rsi::readable_bytes(path).value_or("").find(kNo);
  if (at == std::string::npos) return;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(at));
  file << kYes;
}

bool recording_paused(const std::filesystem::path& folder) {
  const Json run = run_in(folder);
  return run.is_object() && run.value(kRecordingPaused, Json()) == true;
}

void mark_recording_deleted(const std::filesystem::path& folder) {
  Json run = run_in(folder);
  if (!run.is_object()) return;
  run[kRecordingDeleted] = true;
  try {
    write_atomically(folder / file_names::kRun, json_text(run));
  } catch (const std::exception&) {  // what refuses it refuses the recording too, which says so
  }
}

bool recording_deleted(const std::filesystem::path& folder) {
  const Json run = run_in(folder);
  return run.is_object() && run.value(kRecordingDeleted, Json()) == true;
}

}  // namespace sweepd
