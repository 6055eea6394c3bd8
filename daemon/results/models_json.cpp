#include "daemon/results/models_json.hpp"

#include <nlohmann/json.hpp>

#include "daemon/results/models.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using identify::KinematicModel;
using identify::Knowledge;
using identify::Quantity;

void add_numbers(Json& json, const KinematicModel::Group& group) {
  Json by_convention = Json::array();
  for (const auto& [name, quantity, number] : group) {
    const std::string unit = quantity == Quantity::length  ? "_mm"
                             : quantity == Quantity::angle ? "_deg"
                                                           : "";
    const std::string parameter = std::string(name) + unit;
    json[parameter] = in_file_units(number.value, quantity);
    if (number.sigma > 0)
      json[std::string(name) + "_sigma" + unit] = in_file_units(number.sigma, quantity);
    if (number.knowledge == Knowledge::by_convention) by_convention.push_back(parameter);
  }
  if (!by_convention.empty()) json["by_convention"] = std::move(by_convention);
}

}  // namespace

Json models_json(const std::vector<KinematicModel>& models) {
  Json json = Json::object();
  for (const KinematicModel& model : models) {
    Json& one = json[std::string(text(model.form))];
    if (!model.groups.front().empty()) add_numbers(one["base"], model.groups.front());
    one["joints"] = Json::array();
    for (std::size_t j = 1; j <= model.joints(); ++j) {
      Json joint = {{"joint", j}};
      if (model.linear[j - 1]) joint["type"] = "linear";
      add_numbers(joint, model.groups[j]);
      one["joints"].push_back(std::move(joint));
    }
    add_numbers(one["tool"], model.groups.back());
  }
  return json;
}

}  // namespace sweepd
