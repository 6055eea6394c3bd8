#include <nlohmann/json.hpp>

#include "daemon/page/page_json.hpp"
#include "daemon/results/run_json.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "daemon/text/utc.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::nanoseconds;

const char* text(ServiceStatus::Phase phase) {
  switch (phase) {
    case ServiceStatus::Phase::starting:
      return "starting";
    case ServiceStatus::Phase::serving:
      return "serving";
    case ServiceStatus::Phase::stopping:
      break;
  }
  return "stopping";
}

Json stream(const RobotState& state) {
  if (!state.stream) return nullptr;
  const StreamState& stream = *state.stream;
  Json json = {{"session", stream.session},
               {"since", utc_text(stream.since)},
               {"controller", rsi::address_text(stream.controller)}};
  if (stream.cycle.count() > 0) json["cycle_ms"] = rounded(ms(stream.cycle), 3);
  if (state.replies)
    json["reply_latency"] = {{"p50_us", us(stream.latency_p50)},
                             {"p99_us", us(stream.latency_p99)},
                             {"max_us", us(stream.latency_max)}};
  return json;
}

Json verdict(const RobotState& state) {
  if (!state.verdict) return nullptr;
  return {{"verdict", rsi::text(state.verdict->grade)}, {"reason", state.verdict->reason}};
}

Json telegrams(const LinkTotals& link) {
  return {{"received", link.telegrams},
          {"lost", link.lost},
          {"duplicated", link.duplicated},
          {"reordered", link.reordered},
          {"malformed", link.malformed},
          {"ipoc_restarts", link.restarts},
          {"clock_steps", link.clock_steps},
          {"mean_jitter_us", rounded(link.jitter.mean_s() * 1e6, 3)}};
}

Json replies(const RobotState& state) {
  const LinkTotals& link = state.link;
  return {{"sent", state.server.answered},
          {"refused", state.server.refused},
          {"not_begun", state.server.not_begun},
          {"send_failures", state.server.send_failures},
          {"in_time", link.in_time},
          {"late", link.late},
          {"superseded", link.superseded},
          {"unanswered", link.unanswered},
          {"missed_by_controller",
           link.missed_by_controller ? Json(*link.missed_by_controller) : Json()},
          {"mean_latency_us", rounded(link.latency.mean_s() * 1e6, 3)}};
}

Json recording(const RobotState& state) {
  const Recording::Counts& counts = state.recording;
  return {
      {"paused", state.recording_paused},
      {"pauses", counts.pauses},
      {"bytes", counts.bytes},
      {"files", counts.files},
      {"recorded", records_json(counts.recorded)},
      {"missed",
       {{"memory_full", records_json(counts.memory_full)}, {"disk", records_json(counts.disk)}}},
      {"folders_deleted", counts.folders_deleted}};
}

Json sweeps(const RobotState& state) {
  Json json = Json::array();
  for (const auto& [joint, counts] : state.sweeps) {
    Json row;
    if (joint > 0) row["joint"] = joint;
    row["usable"] = counts.usable;
    row["not_usable"] = counts.not_usable;
    json.push_back(std::move(row));
  }
  return json;
}

Json identifications(const ResultState& result) {
  Json json;
  for (std::size_t i = 0; i < result.count.size(); ++i)
    json[std::string(identify::text(static_cast<identify::Status>(i)))] = result.count[i];
  return json;
}

Json newest_result(const ResultState& result) {
  if (!result.newest) return nullptr;
  const ResultState::Newest& newest = *result.newest;
  return {{"status", identify::text(newest.status)},
          {"interim", newest.interim},
          {"session", newest.session},
          {"at", utc_text(newest.at)},
          {"took_ms", rounded(ms(newest.took), 3)},
          {"warnings", newest.warnings}};
}

}  // namespace

Json robot_state_json(const RobotMetrics& metrics) {
  const RobotState& state = *metrics.state;
  return {{"robot", state.name},
          {"listen", rsi::text(state.listen)},
          {"transport", rsi::text(state.transport)},
          {"replies_expected", state.replies},
          {"stream", stream(state)},
          {"link", verdict(state)},
          {"sessions", state.sessions},
          {"telegrams", telegrams(state.link)},
          {"replies", replies(state)},
          {"dropped",
           {{"foreign", state.server.foreign},
            {"receive_buffer_full", state.server.dropped},
            {"queue_full", state.server.overflows}}},
          {"recording", recording(state)},
          {"sweeps", sweeps(state)},
          {"identifications", identifications(*metrics.result)},
          {"results_pending", state.results.pending},
          {"results_refused", state.results.refused},
          {"results_given_up", state.results.given_up},
          {"result", newest_result(*metrics.result)}};
}

std::string state_json(const ServiceStatus& status, const std::vector<RobotMetrics>& robots,
                       const ProcessState& process) {
  Json json = {{"schema", schemas::kState},
               {"version", SWEEPD_VERSION},
               {"started", utc_text(process.started)},
               {"phase", text(status.phase)},
               {"standstills", status.standstills},
               {"log_lines_lost", process.log_lines_lost},
               {"not_served", Json::array()},
               {"robots", Json::array()}};
  for (const auto& [robot, reason] : status.not_served)
    json["not_served"].push_back({{"robot", robot}, {"reason", reason}});
  for (const RobotMetrics& metrics : robots) json["robots"].push_back(robot_state_json(metrics));
  return json.dump(2) + "\n";
}

}  // namespace sweepd
