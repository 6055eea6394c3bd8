#include "daemon/krl/krl_position.hpp"
#include "daemon/results/correction.hpp"
#include "daemon/results/json_parts.hpp"
#include "daemon/results/poses_json.hpp"
#include "identify/sweeps/sample.hpp"

namespace sweepd {
namespace {

using identify::ControllerNumber;
using Json = nlohmann::ordered_json;
using Verdict = ControllerNumber::Verdict;

Json lengths(const Eigen::Vector3d& mm) {
  return {json_length(mm.x()), json_length(mm.y()), json_length(mm.z())};
}

Json angles(const Eigen::Vector3d& rad) {
  return {json_angle(rad.x()), json_angle(rad.y()), json_angle(rad.z())};
}

Json frame_json(const Eigen::Isometry3d& frame) {
  const auto abc = identify::abc_of(frame.linear());
  return {{"krl", krl_frame_text(frame)},
          {"position_mm", lengths(frame.translation())},
          {"abc_deg", angles({abc[0], abc[1], abc[2]})}};
}

bool determined(const Correction& correction, std::size_t from, std::size_t count) {
  for (std::size_t k = from; k < from + count; ++k)
    if (!correction.fit.frames_determined[k]) return false;
  return true;
}

Json frames_json(const Correction& correction) {
  Json json;
  const auto sigma = correction.base_sigma();
  Json& base = json["base"] = frame_json(correction.base_frame());
  base["determined"] = determined(correction, 0, 6);
  base["sigma_mm"] = lengths(sigma.head<3>());
  base["rotation_sigma_deg"] = angles(sigma.tail<3>());
  json["tools"] = Json::array();
  for (std::size_t t = 0; t < correction.targets.size(); ++t) {
    Json tool = {{"target", correction.targets[t]}};
    tool.update(frame_json(correction.tool_frame(t)));
    tool["determined"] = determined(correction, 6 + 3 * t, 3);
    tool["sigma_mm"] = lengths(correction.tool_sigma_mm(t));
    json["tools"].push_back(std::move(tool));
  }
  return json;
}

const char* verdict(const ControllerNumber& number) {
  switch (number.verdict) {
    case Verdict::significant:
      return "significant";
    case Verdict::not_significant:
      return "not_significant";
    case Verdict::inseparable:
      return "inseparable";
  }
  return "";
}

Json number_json(const Correction& correction, const ControllerNumber& number) {
  const auto& arm = correction.specified;
  using Kind = ControllerNumber::Kind;
  const bool zero = number.kind == Kind::zero;
  const bool length =
      number.kind == Kind::a || number.kind == Kind::b || arm.is_linear(number.joint);
  const auto value = [&](double of) { return length ? json_length(of) : json_angle(of); };
  const bool known = number.verdict != Verdict::inseparable;
  Json json = {{"name", name_of(number, arm) + (length ? "_mm" : "_deg")},
               {"joint", number.joint + 1},
               {"verdict", verdict(number)},
               {"change", known ? value(number.change) : Json()},
               {"sigma", known ? value(number.sigma) : Json()},
               {"p", known ? Json(number.chance) : Json()}};
  if (zero) json["offset"] = known ? value(correction.offset(number)) : Json();
  return json;
}

Json point_json(const CorrectedPoint& point) {
  Json json = {{"name", point.name}, {"line", point.line}, {"type", point.type}};
  json["corrected"] = !point.left;
  if (point.left) return json;
  json["shift_mm"] = json_length(point.shift_mm);
  json["turn_deg"] = json_angle(point.turn_rad);
  json["expected_mm"] = json_length(point.expected_mm);
  json["angles_deg"] = Json::array();
  for (const double angle : point.angles_rad) json["angles_deg"].push_back(json_angle(angle));
  json["outside"] = point.outside;
  json["from_target_mm"] = json_length(point.from_target_mm);
  return json;
}

}  // namespace

Json correction_json(const Correction& correction) {
  Json json = {{"schema", "sweepd.correction/1"},
               {"level", text(correction.level)},
               {"robot", correction.robot},
               {"poses", correction.poses}};
  json["left"] = {{"frames", json_left(correction.frames)},
                  {"corrected", json_left(correction.left)},
                  {"identified", json_left(correction.identified)}};
  json["unheld"] = json_left(correction.unheld);
  json["frames"] = frames_json(correction);
  json["numbers"] = Json::array();
  for (const auto& number : correction.fit.numbers)
    json["numbers"].push_back(number_json(correction, number));
  if (correction.program) {
    json["points"] = Json::array();
    for (const auto& point : correction.program->points)
      json["points"].push_back(point_json(point));
  }
  json["warnings"] = correction.warnings();
  return json;
}

}  // namespace sweepd
