#include "daemon/results/run_json.hpp"

#include <fstream>

#include <nlohmann/json.hpp>

#include "daemon/text/file_names.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

Json json(const RecordCount& count) {
  return {{"datagrams", count.datagrams}, {"samples", count.samples}};
}

Json json(const Recording::Counts& counts) {
  Json recording = {
      {"files", counts.files},
      {"bytes", counts.bytes},
      {"datagrams", counts.recorded.datagrams},
      {"samples", counts.recorded.samples},
      {"not_recorded", {{"memory_full", json(counts.memory_full)}, {"disk", json(counts.disk)}}},
      {"paused", counts.pauses}};
  if (counts.folders_deleted > 0) {
    recording["folders_deleted"] = counts.folders_deleted;
    recording["deleted"] = json(counts.deleted);
  }
  if (counts.files_deleted > 0) recording["files_deleted"] = counts.files_deleted;
  return recording;
}

std::string text(const Json& run) {
  return run.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json json(const std::vector<FileHash>& inputs) {
  Json list = Json::array();
  for (const FileHash& input : inputs)
    list.push_back(
        {{"file", input.file.string()}, {"bytes", input.bytes}, {"sha256", input.sha256}});
  return list;
}

Json begun(std::string_view command) {
  return {{"schema", "sweepd.run/1"}, {"sweepd", SWEEPD_VERSION}, {"command", command}};
}

}  // namespace

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
  if (facts.recording) run["recording"] = json(*facts.recording);
  return text(run);
}

std::string run_json(std::string_view command, const Json& given,
                     const std::vector<std::string>& arguments,
                     const std::vector<FileHash>& inputs) {
  Json run = begun(command);
  run.update(given);
  if (!arguments.empty()) run["arguments"] = arguments;
  if (!inputs.empty()) run["inputs"] = json(inputs);
  return text(run);
}

std::string run_json_of_cut_session(const std::filesystem::path& folder, const std::string& ended,
                                    bool from_recording, const std::vector<std::string>& damage) {
  std::ifstream stream(folder / file_names::kRun, std::ios::binary);
  Json run = Json::parse(stream, nullptr, false);
  if (!run.is_object()) run = begun("run");
  run["ended"] = ended;
  if (from_recording) run["from_recording"] = true;
  if (!damage.empty()) run["damage"] = damage;
  return text(run);
}

}  // namespace sweepd
