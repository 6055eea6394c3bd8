#include "daemon/run_json.hpp"

#include <nlohmann/json.hpp>

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

Json json(const RecordCount& count) {
  return {{"datagrams", count.datagrams}, {"samples", count.samples}};
}

Json json(const Recording::Counts& counts) {
  return {
      {"files", counts.files},
      {"bytes", counts.bytes},
      {"datagrams", counts.recorded.datagrams},
      {"samples", counts.recorded.samples},
      {"not_recorded", {{"memory_full", json(counts.memory_full)}, {"disk", json(counts.disk)}}},
      {"paused", counts.pauses}};
}

}  // namespace

std::string run_json(const RunFacts& facts) {
  Json run = {{"schema", "sweepd.run/1"},
              {"sweepd", SWEEPD_VERSION},
              {"command", "run"},
              {"robot", facts.robot},
              {"started", facts.started}};
  if (!facts.ended.empty()) run["ended"] = facts.ended;
  run["folder"] = facts.folder.string();
  run["description"] = facts.description.string();
  if (facts.ethernet_config) run["ethernet_config"] = facts.ethernet_config->string();
  run["listen"] = rsi::text(facts.listen);
  run["since_start_of_sweepd"] = {{"answered", facts.link.answered},
                                  {"superseded", facts.link.superseded},
                                  {"unanswerable", facts.link.unanswerable},
                                  {"foreign", facts.link.foreign},
                                  {"refused", facts.link.refused},
                                  {"cut", facts.link.cut},
                                  {"send_failures", facts.link.send_failures},
                                  {"dropped", facts.link.dropped},
                                  {"skipped_bytes", facts.link.skipped},
                                  {"overflows", facts.link.overflows}};
  if (facts.recording) run["recording"] = json(*facts.recording);
  return run.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sweepd
