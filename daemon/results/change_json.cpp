
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/results/change.hpp"
#include "daemon/text/json_text.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using identify::ArmNumber;
using identify::LeftOutBecause;

/// More digits than a number's own: differences of two are smaller.
double in_file(const ArmNumber& number, double value) {
  return rounded(number.length ? value : degrees(value), 9);
}

const char* text(LeftOutBecause because) {
  switch (because) {
    case LeftOutBecause::frame:
      return "frame";
    case LeftOutBecause::no_home:
      return "no_home";
    case LeftOutBecause::other_home:
      return "other_home";
    case LeftOutBecause::convention:
      return "convention";
  }
  return "";
}

Json result(const ToldArm& told) {
  return {{"file", told.file.string()}, {"robot", told.robot}, {"status", told.status}};
}

Json numbers(const Change& change) {
  Json json = Json::array();
  for (std::size_t k = 0; k < change.arms.numbers.size(); ++k) {
    const ArmNumber& number = change.arms.numbers[k];
    const auto& found = change.test.numbers[k];
    const auto at = static_cast<Eigen::Index>(k);
    json.push_back({{"name", name_with_unit(number)},
                    {"joint", number.joint + 1},
                    {"a", in_file(number, change.arms.first(at))},
                    {"b", in_file(number, change.arms.second(at))},
                    {"difference", in_file(number, change.arms.difference(at))},
                    {"sigma", in_file(number, found.sigma)},
                    {"p", rounded(found.p, 6)},
                    {"smallest_change", in_file(number, found.smallest)},
                    {"changed", found.changed}});
  }
  return json;
}

Json displacement(const identify::Displacement& found) {
  Json turns = Json::array();
  for (const double turn : found.turns_rad) turns.push_back(rounded(degrees(turn), 3));
  return {{"largest_mm", rounded(found.largest_mm, 6)},
          {"low_mm", rounded(found.low_mm, 6)},
          {"high_mm", rounded(found.high_mm, 6)},
          {"turns_deg", std::move(turns)}};
}

}  // namespace

std::string change_json(const Change& change) {
  Json json = {{"schema", "sweepd.compare/1"},
               {"verdict", change.test.changed ? "changed" : "no_change_seen"},
               {"level", change.level},
               {"describes", change.first.describes},
               {"joints", change.first.joints()},
               {"a", result(change.first)},
               {"b", result(change.second)},
               {"t_squared", rounded(change.test.t_squared, 4)},
               {"degrees_of_freedom", change.arms.numbers.size()},
               {"p", rounded(change.test.p, 6)},
               {"power", kPower},
               {"numbers", numbers(change)}};
  json["left_out"] = Json::array();
  for (const auto& one : change.arms.left_out)
    json["left_out"].push_back(
        {{"name", name_with_unit(one.number)}, {"because", text(one.because)}});
  json["displacement"] = displacement(change.displacement);
  if (change.changes_displacement)
    json["displacement_by_changes"] = displacement(*change.changes_displacement);
  json["poses"] = kComparedPoses;
  json["within_limits"] = change.first.with_limits;
  json["notes"] = change.notes;
  return json_text(json);
}

}  // namespace sweepd
