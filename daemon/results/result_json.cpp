#include <algorithm>
#include <chrono>
#include <cmath>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/report/report_folder.hpp"
#include "daemon/results/json_parts.hpp"
#include "daemon/results/models.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/results/poses_json.hpp"
#include "daemon/results/result_formats.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/json_text.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/chain/delay.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using identify::Identification;
using identify::JointResult;

Json vector(const Eigen::Vector3d& v, int decimals) {
  return {rounded(v.x(), decimals), rounded(v.y(), decimals), rounded(v.z(), decimals)};
}
Json point(const Eigen::Vector3d& mm) {
  return vector(mm, kLengthDecimals);
}
Json direction(const Eigen::Vector3d& unit) {
  return vector(unit, 9);
}

Json source(const Outcome& outcome) {
  const auto& counts = outcome.counts;
  Json json = {{"kind", outcome.source_kind},
               {"telegrams", counts.link.telegrams},
               {"lost", counts.link.lost},
               {"duplicated", counts.link.duplicated},
               {"reordered", counts.link.reordered},
               {"malformed", counts.malformed_in_all()},
               {"restarts", counts.link.restarts},
               {"late_replies", nullptr},
               {"late_runs", nullptr},
               {"longest_late_run", nullptr},
               {"unusable_values", counts.unusable_values},
               {"cycle_ms", nullptr}};
  if (counts.link.late_replies) {
    json["late_replies"] = *counts.link.late_replies;
    json["late_runs"] = counts.link.late_runs;
    json["longest_late_run"] = counts.link.longest_late_run;
  }
  if (counts.cycle)
    json["cycle_ms"] = rounded(std::chrono::duration<double, std::milli>(*counts.cycle).count(), 3);
  Json kinds = Json::object();
  for (std::size_t k = 1; k < counts.malformed.size(); ++k)
    if (counts.malformed[k] > 0)
      kinds[std::string(rsi::text(static_cast<rsi::Defect>(k)))] = counts.malformed[k];
  if (!kinds.empty()) json["malformed_by_kind"] = std::move(kinds);
  if (outcome.points) {
    json["points"] = outcome.points->points;
    json["files"] = outcome.points->files;
    json["targets"] = outcome.points->targets.size();
    if (outcome.points->poses > 0) json["poses"] = outcome.points->poses;
  }
  if (outcome.motion_limit)
    json["motion_limit"] = {{"noise_mm", json_length(outcome.motion_limit->noise_mm)},
                            {"slowest_mm_s", rounded(outcome.motion_limit->slowest_mm_s, 3)},
                            {"shortest_mm", rounded(outcome.motion_limit->shortest_mm, 3)}};
  return json;
}

Json clocks(const JoinedClocks& joined) {
  const auto& clock = joined.clock;
  return {{"ahead_s", rounded(clock.ahead_s, 9)},
          {"sigma_ms", rounded(1e3 * clock.sigma_s, 6)},
          {"rate_ppm", rounded(1e6 * clock.rate, 3)},
          {"rate_sigma_ppm", rounded(1e6 * clock.rate_sigma, 3)},
          {"at_s", rounded(clock.at_s, 6)},
          {"motions", clock.matched},
          {"motions_of_one_alone", clock.strange},
          {"sweeps", joined.sweeps},
          {"rests", joined.poses},
          {"restless_rests", joined.restless},
          {"left_out_s", rounded(joined.left_out_s, 3)},
          {"fastest_mm_s", rounded(joined.fastest_mm_s, 3)}};
}

/// Of each joint, lowest and highest; null where the description has none.
Json limits(const std::vector<JointLimits>& all) {
  Json json = Json::array();
  for (const JointLimits& limit : all) {
    const bool known = std::isfinite(limit.min_deg) && std::isfinite(limit.max_deg);
    json.push_back(known ? Json{limit.min_deg, limit.max_deg} : Json());
  }
  return json;
}

/// Row by row; the columns are the directions of a frame.
Json rotation(const Eigen::Matrix3d& matrix) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < 3; ++row) rows.push_back(direction(matrix.row(row).transpose()));
  return rows;
}

Json box(const identify::BoundingBox& box) {
  return {{"lengths_mm", point(box.lengths_mm)},
          {"volume_m3", rounded(box.volume_mm3() * 1e-9, 12)},
          {"center", point(box.center_mm)},
          {"orientation", rotation(box.orientation)},
          {"gap", rounded(box.gap, 15)}};
}

Json joint(std::size_t index, const JointResult& result, bool timed) {
  Json sweeps = Json::array();
  for (std::size_t s = 0; s < result.sweeps.size(); ++s) {
    const auto& sweep = result.sweeps[s];
    Json json = {{"samples", sweep.samples->size()},
                 {"start_s", timed ? Json(rounded(sweep.first().time_s, 6)) : Json()},
                 {"end_s", timed ? Json(rounded(sweep.last().time_s, 6)) : Json()},
                 {result.linear ? "range_mm" : "range_deg", json_angle(sweep.range_rad)},
                 {"direction", sweep.direction}};
    if (sweep.positioning) json["positioning"] = true;
    json["used"] = static_cast<bool>(result.used[s]);
    sweeps.push_back(std::move(json));
  }
  Json json = {{"joint", index + 1}};
  if (result.linear) json["type"] = "linear";
  json["sweeps"] = std::move(sweeps);
  if (result.axis)
    json["axis"] = {{"direction", direction(result.axis->direction)},
                    {"point", point(result.axis->point_mm)},
                    {"direction_sigma_deg", json_angle(result.axis->direction_sigma_rad())},
                    {"point_sigma_mm", json_length(result.axis->point_sigma_mm())}};
  if (result.axis && result.axis->linear) {
    json["axis"]["point_sigma_mm"] = nullptr;
    json["axis"]["by_convention"] = {"point"};
  }
  if (result.line)
    json["line"] = {{"point", point(result.line->point_mm)},
                    {"direction", direction(result.line->direction)},
                    {"length_mm", json_length(result.line->length_mm)},
                    {"across_rms_mm", json_length(result.line->across_rms_mm)},
                    {"bend_mm", json_length(result.line->bend_mm)},
                    {"bend_sigma_mm", json_length(result.line->bend_sigma_mm)}};
  if (result.circle)
    json["circle"] = {{"center", point(result.circle->center_mm)},
                      {"normal", direction(result.circle->normal)},
                      {"radius_mm", json_length(result.circle->radius_mm)},
                      {"arc_deg", json_angle(result.circle->arc_rad)},
                      {"plane_rms_mm", json_length(result.circle->plane_rms_mm)},
                      {"radial_rms_mm", json_length(result.circle->radial_rms_mm)}};
  if (result.box) json["bounding_box"] = box(*result.box);
  return json;
}

Json estimates(const Identification& found) {
  Json json = {{"circle", {{"dh", dh_json(found.circle_dh)}}}};
  if (found.chain) {
    json["chain"] = {{"dh", dh_json(found.chain->dh)}};
    json["chain"].update(chain_json(*found.chain));
  }
  return json;
}

Json messages(const std::vector<identify::Warning>& all) {
  Json json = Json::array();
  for (const auto& one : all) {
    Json item = {{"code", one.code}};
    if (one.joint) item["joint"] = *one.joint + 1;
    item["message"] = one.message;
    json.push_back(std::move(item));
  }
  return json;
}

/// JSON has no word for what is not finite: it becomes null, and its place is named.
void leave_out_not_finite(Json& json, const std::string& place, Json& places) {
  if (json.is_structured())
    for (auto& [key, value] : json.items())
      leave_out_not_finite(value, fmt::format("{}/{}", place, key), places);
  else if (json.is_number_float() && !std::isfinite(json.get<double>())) {
    json = nullptr;
    places.push_back(place);
  }
}

/// JSON as a person reads it: short lists and objects of plain values on one line.
void print(const Json& json, const std::string& indent, std::string& out) {
  if (!json.is_structured() || json.empty()) {
    out += json_line(json);
    return;
  }
  constexpr std::size_t kShort = 8;
  const auto is_number = [](const Json& item) { return item.is_number(); };
  const bool numbers = json.is_array() && std::all_of(json.begin(), json.end(), is_number);
  const bool one_line =
      (json.size() <= kShort || numbers) && (json.is_array() || !indent.empty()) &&
      std::none_of(json.begin(), json.end(),
                   [](const Json& item) { return item.is_structured() && !item.empty(); });
  const std::string inner = indent + "  ";
  out += json.is_array() ? "[" : "{";
  std::string_view separator;
  for (const auto& [key, value] : json.items()) {
    out += separator;
    if (!one_line) out += "\n" + inner;
    if (json.is_object()) out += json_line(Json(key)) + ": ";
    print(value, inner, out);
    separator = one_line ? ", " : ",";
  }
  if (!one_line) out += "\n" + indent;
  out += json.is_array() ? "]" : "}";
}

}  // namespace

std::string result_json(const Outcome& outcome) {
  const Identification& found = outcome.identification;
  Json json = {{"schema", schemas::kResult},
               {"robot", outcome.robot},
               {"status", identify::text(found.status)}};
  if (!found.reason.empty()) json["reason"] = found.reason;
  json["describes"] = text(described(outcome));
  json["explanation"] = explanation(outcome);
  Json home = Json::array();
  for (const auto& home_rad : found.home_rad)
    home.push_back(home_rad ? json_angle(*home_rad) : Json());
  const auto known = [](const Json& angle_deg) { return !angle_deg.is_null(); };
  if (std::any_of(home.begin(), home.end(), known)) json["home_deg"] = std::move(home);
  if (outcome.angle_step_rad > 0) json["angle_step_deg"] = json_angle(outcome.angle_step_rad);
  if (!outcome.limits.empty()) json["limits_deg"] = limits(outcome.limits);
  json["source"] = source(outcome);
  json["estimator"] = identify::text(found.estimator);
  json["joints"] = Json::array();
  for (std::size_t j = 0; j < found.joints.size(); ++j)
    json["joints"].push_back(joint(j, found.joints[j], is_timed(outcome)));
  json["dh"] = dh_json(found.dh);
  for (std::size_t j = 0; j < json["dh"].size() && j < outcome.positive.size(); ++j)
    json["dh"][j]["positive"] = outcome.positive[j];
  if (found.dh_covariance.size() > 0) {
    json["covariance"] = covariance_json(found);
    json["uncertainty_budget"] = budget_json(found);
  }
  if (found.estimator != identify::Estimator::axes) json["estimates"] = estimates(found);
  if (!found.specified.empty()) {
    json["specified"] = dh_json(found.specified);
    json["difference"] = dh_json(compare_with_specified(found.dh, found.specified, found.home_rad));
  }
  if (outcome.joined) json["clocks"] = clocks(*outcome.joined);
  if (found.delay)
    json["delay"] = {{"late_ms", rounded(1e3 * found.delay->late_s, 6)},
                     {"sigma_ms", rounded(1e3 * found.delay->sigma_s, 6)},
                     {"rate_ppm", rounded(1e6 * found.delay->rate, 3)},
                     {"at_s", rounded(found.delay->at_s, 6)},
                     {"corrected", is_significant(*found.delay)}};
  if (found.tool) {
    json["tool"] = {{"point_mm", point(found.tool->translation())}};
    if (found.row_to_tool) {
      json["tool"]["orientation"] = rotation(found.tool->linear());
      json["tool"]["dh_row"] = dh_json(found.dh.size() - 1, *found.row_to_tool);
    }
  }
  if (found.robot_pose) {
    const auto& robot = *found.robot_pose;
    json["robot_pose"] = {
        {"position_mm", point(robot.pose.translation())},
        {"position_sigma_mm", point(robot.position_sigma_mm)},
        {"orientation", rotation(robot.pose.linear())},
        {"rotation_sigma_deg", vector(degrees(1) * robot.rotation_sigma_rad, kAngleDecimals)}};
  }
  if (!outcome.currents.empty()) json["currents"] = currents_json(outcome);
  if (found.poses) json["poses"] = poses_json(outcome);
  if (const auto models = models_of(outcome); !models.empty()) json["models"] = models_json(models);
  if (found.bounding_box) json["bounding_box"] = box(*found.bounding_box);
  if (!found.doubts.empty()) json["doubts"] = messages(found.doubts);
  json["warnings"] = messages(found.warnings);
  Json not_finite = Json::array();
  leave_out_not_finite(json, "", not_finite);
  if (!not_finite.empty()) json["not_finite"] = std::move(not_finite);
  std::string out;
  print(json, "", out);
  return out + "\n";
}

}  // namespace sweepd
