
#include <cmath>

#include <nlohmann/json.hpp>

#include "daemon/page/page_json.hpp"
#include "daemon/results/json_parts.hpp"
#include "daemon/text/json_text.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "daemon/text/utc.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value, int decimals) {
  return std::isfinite(value) ? Json(rounded(value, decimals)) : Json();
}

Json place(const std::array<float, 3>& mm) {
  return {number(mm[0], 2), number(mm[1], 2), number(mm[2], 2)};
}

Json some_us(float value) {
  return value < 0 ? Json() : number(value, 1);
}

/// Each number becomes text, as it is printed.
void keep_digits(Json& json) {
  if (json.is_structured())
    for (auto& item : json) keep_digits(item);
  else if (json.is_number())
    json = json.dump();
}

Json in_digits(Json json) {
  if (!json.is_array()) return json;
  for (auto& row : json) {
    const Json joint = row.value("joint", Json());
    keep_digits(row);
    row["joint"] = joint;
  }
  return json;
}

}  // namespace

std::string hello_json(const std::string& robot, const RobotFacts& facts) {
  Json json = {{"schema", "sweepd.live/1"},
               {"version", SWEEPD_VERSION},
               {"robot", robot},
               {"joints", facts.joints},
               {"describes", "controller_model"}};
  if (!facts.specified.empty()) json["specified"] = in_digits(dh_json(facts.specified));
  if (!facts.home_deg.empty()) json["home"] = facts.home_deg;
  Json limits = Json::array();
  for (const auto& limit : facts.limits)
    limits.push_back({{"min", number(limit.min_deg, 6)},
                      {"max", number(limit.max_deg, 6)},
                      {"unit", limit.linear ? "mm" : "deg"}});
  if (!limits.empty()) json["limits"] = std::move(limits);
  return json_line(json);
}

std::string cycles_json(const std::vector<LiveSlice>& slices) {
  Json json = {{"session", slices.front().session}};
  for (const auto& slice : slices) {
    json["at_s"].push_back(number(slice.at_s, 2));
    json["cycles"].push_back(slice.cycles);
    json["late"].push_back(slice.late);
    json["superseded"].push_back(slice.superseded);
    json["unanswered"].push_back(slice.unanswered);
    json["latency_us"].push_back(some_us(slice.latency_us));
    json["latency_max_us"].push_back(some_us(slice.latency_max_us));
    json["jitter_us"].push_back(some_us(slice.jitter_us));
  }
  return json_line(json);
}

std::string samples_json(const std::vector<LiveSlice>& slices) {
  Json t = Json::array(), positions = Json::array(), angles = Json::array();
  for (const auto& slice : slices)
    for (std::size_t p = 0; p < slice.count; ++p) {
      const auto& point = slice.points[p];
      t.push_back(number(point.t_s, 3));
      positions.push_back(point.has_position ? place(point.position_mm) : Json());
      Json row = Json::array();
      for (std::size_t j = 0; j < slice.joints; ++j) row.push_back(number(point.angles_deg[j], 3));
      angles.push_back(std::move(row));
    }
  return json_line({{"session", slices.front().session},
                    {"t_s", std::move(t)},
                    {"position_mm", std::move(positions)},
                    {"angles", std::move(angles)}});
}

std::string sweep_json(const LiveSweep& sweep) {
  Json path = Json::array();
  for (const auto& mm : sweep.path) path.push_back(place(mm));
  Json json = {{"session", sweep.session},
               {"started", sweep.started},
               {"joint", sweep.joint ? Json(*sweep.joint) : Json()},
               {"start_s", Json(rounded(sweep.start_s, 6)).dump()},
               {"end_s", Json(rounded(sweep.end_s, 6)).dump()},
               {"range", Json(rounded(sweep.range, kAngleDecimals)).dump()},
               {"unit", sweep.linear ? "mm" : "deg"},
               {"ends", sweep.ends ? Json(*sweep.ends) : Json()},
               {"direction", sweep.direction},
               {"usable", sweep.usable},
               {"words", sweep.words},
               {"path_mm", std::move(path)}};
  return json_line(json);
}

std::string link_json(const RobotMetrics& robot) {
  return json_line(robot_state_json(robot));
}

std::string result_event_json(const ResultState::Newest& result) {
  const Json whole = Json::parse(*result.json, nullptr, false);
  Json json = {{"session", result.session},
               {"interim", result.interim},
               {"at", utc_text(result.at)},
               {"status", identify::text(result.status)}};
  if (!whole.is_object()) return json_line(json);
  for (const char* key : {"reason", "describes", "estimator", "doubts", "warnings"})
    if (whole.contains(key)) json[key] = whole[key];
  for (const char* key : {"dh", "specified", "difference"})
    if (whole.contains(key)) json[key] = in_digits(whole[key]);
  json["sweeps"] = Json::array();
  for (const auto& joint : whole.value("joints", Json::array()))
    for (auto sweep : joint.value("sweeps", Json::array())) {
      keep_digits(sweep);
      sweep["joint"] = joint.value("joint", Json());
      json["sweeps"].push_back(std::move(sweep));
    }
  return json_line(json);
}

}  // namespace sweepd
