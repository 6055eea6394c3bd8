#include "daemon/results/models.hpp"

#include <nlohmann/json.hpp>

#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using identify::KinematicModel;
using identify::Knowledge;
using identify::Quantity;

constexpr std::string_view unit(Quantity quantity) {
  switch (quantity) {
    case Quantity::length:
      return "mm";
    case Quantity::angle:
      return "deg";
    case Quantity::ratio:
      return "1";
  }
  return "";
}

void add_numbers(Json& json, const KinematicModel::Group& group) {
  Json by_convention = Json::array();
  for (const auto& [name, quantity, number] : group) {
    const std::string unit = quantity == Quantity::length  ? "_mm"
                             : quantity == Quantity::angle ? "_deg"
                                                           : "";
    const std::string parameter = std::string(name) + unit;
    json[parameter] = in_file_units(number.value, quantity);
    if (number.has_sigma())
      json[std::string(name) + "_sigma" + unit] = in_file_units(number.sigma, quantity);
    if (number.knowledge == Knowledge::by_convention) by_convention.push_back(parameter);
  }
  if (!by_convention.empty()) json["by_convention"] = std::move(by_convention);
}

}  // namespace

std::vector<identify::KinematicModel> models_of(const Outcome& outcome) {
  const auto& found = outcome.identification;
  using identify::Estimator;
  if (!found.chain || (found.estimator != Estimator::chain && found.estimator != Estimator::poses))
    return {};
  const identify::ChainEstimate& estimate = *found.chain;
  return identify::kinematic_models({estimate.chain, outcome.positive, estimate.dh,
                                     estimate.covariance, found.home_rad,
                                     estimate.with_orientation});
}

double in_file_units(double value, identify::Quantity quantity) {
  return (quantity == identify::Quantity::angle ? degrees(value) : value) + 0.0;
}

std::string models_csv(const std::vector<identify::KinematicModel>& models) {
  std::string csv = "model,joint,parameter,value,unit,sigma,low_95,high_95,knowledge\n";
  for (const auto& model : models)
    for (std::size_t joint = 0; joint < model.groups.size(); ++joint)
      for (const auto& [name, quantity, number] : model.groups[joint]) {
        const auto in_text = [&, of = quantity](double value) {
          return number_text(in_file_units(value, of));
        };
        csv += std::string(text(model.form)) + ',' + std::to_string(joint) + ',' +
               std::string(name) + ',' + in_text(number.value) + ',' + std::string(unit(quantity)) +
               ',';
        if (number.has_sigma()) {
          const double half = identify::kSigmasOf95Percent * number.sigma;
          csv += in_text(number.sigma) + ',' + in_text(number.value - half) + ',' +
                 in_text(number.value + half);
        } else {
          csv += ",,";
        }
        csv += number.knowledge == Knowledge::identified ? ",identified\n" : ",by_convention\n";
      }
  return csv;
}

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
