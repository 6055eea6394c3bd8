
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/results/json_parts.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using identify::DhDifference;
using identify::DhEstimate;
using identify::DhNumber;
using identify::DhRow;
using identify::Identification;
using identify::kDhNumbers;
using identify::Knowledge;

/// Twelve significant digits: numbers along axes that are nearly parallel are correlated closely.
Json significant(double value) {
  if (value == 0 || !std::isfinite(value)) return value;
  return rounded(value, 11 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
}

/// A number of the table, as "a3_mm".
struct NumberPlace {
  Eigen::Index row = 0;  ///< of `dh_covariance`
  std::string name;
  double unit = 1;  ///< of the file, in mm or rad
};

/// With those that are by convention for the base's height alone: they have a variance.
std::vector<NumberPlace> measured_numbers(const Identification& found) {
  std::vector<NumberPlace> places;
  for (std::size_t i = 0; i < found.dh.size(); ++i) {
    for (std::size_t k = 0; k < kDhNumbers.size(); ++k) {
      const auto& of = kDhNumbers[k];
      const auto row = static_cast<Eigen::Index>(kDhNumbers.size() * i + k);
      if (!(found.dh[i].*of.number).has_sigma() &&
          !(found.dh_covariance.size() > 0 && found.dh_covariance(row, row) > 0))
        continue;
      places.push_back(
          {row, fmt::format("{}{}_{}", of.name, i + 1, of.unit()), of.length ? 1 : degrees(1)});
    }
  }
  return places;
}

}  // namespace

Json dh_json(std::size_t index, const DhEstimate& row) {
  Json json = {{"joint", index + 1}};
  Json by_convention = Json::array();
  for (const auto& of : kDhNumbers) {
    if (of.number == &DhEstimate::beta_rad && !has_beta(row)) continue;
    const DhNumber& number = row.*of.number;
    const auto in_unit = of.length ? json_length : json_angle;
    const auto key = [&](std::string_view what) {
      return fmt::format("{}{}_{}", of.name, what, of.unit());
    };
    const bool known = number.knowledge != Knowledge::undetermined;
    const bool uncertain = number.has_sigma();
    const double half = identify::kSigmasOf95Percent * number.sigma;
    json[key("")] = known ? in_unit(number.value) : Json();
    json[key("_sigma")] = uncertain ? in_unit(number.sigma) : Json();
    json[key("_low")] = uncertain ? in_unit(number.value - half) : Json();
    json[key("_high")] = uncertain ? in_unit(number.value + half) : Json();
    if (number.knowledge == Knowledge::by_convention) by_convention.push_back(key(""));
  }
  if (row.linear) json["variable"] = "b_mm";
  json["relation"] = identify::text(row.relation);
  if (!by_convention.empty()) json["by_convention"] = std::move(by_convention);
  return json;
}

Json dh_json(const std::vector<DhEstimate>& rows) {
  Json json = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) json.push_back(dh_json(i, rows[i]));
  return json;
}

Json covariance_json(const Identification& found) {
  const auto places = measured_numbers(found);
  Json names = Json::array(), rows = Json::array();
  for (const NumberPlace& r : places) {
    names.push_back(r.name);
    Json row = Json::array();
    for (const NumberPlace& c : places)
      row.push_back(significant(found.dh_covariance(r.row, c.row) * r.unit * c.unit));
    rows.push_back(std::move(row));
  }
  return {{"names", std::move(names)}, {"rows", std::move(rows)}};
}

Json budget_json(const Identification& found) {
  Json rows = Json::array();
  for (const NumberPlace& place : measured_numbers(found)) {
    const double variance = found.dh_covariance(place.row, place.row);
    Json row = {{"number", place.name}};
    for (const auto& share : found.dh_budget)
      row[std::string(identify::text(share.cause))] =
          variance > 0 ? rounded(share.variances(place.row) / variance, 4) : 0.0;
    rows.push_back(std::move(row));
  }
  return rows;
}

Json dh_json(const std::vector<DhRow>& rows) {
  Json json = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i)
    json.push_back({{"joint", i + 1},
                    {"b_mm", json_length(rows[i].b_mm)},
                    {"theta_deg", json_angle(rows[i].theta_rad)},
                    {"a_mm", json_length(rows[i].a_mm)},
                    {"alpha_deg", json_angle(rows[i].alpha_rad)}});
  return json;
}

Json dh_json(const std::vector<DhDifference>& rows) {
  const auto optional = [](const std::optional<double>& value, auto unit) {
    return value ? unit(*value) : Json();
  };
  Json json = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    json.push_back({{"joint", i + 1},
                    {"b_mm", optional(rows[i].b_mm, json_length)},
                    {"theta_deg", optional(rows[i].theta_rad, json_angle)},
                    {"a_mm", optional(rows[i].a_mm, json_length)},
                    {"alpha_deg", optional(rows[i].alpha_rad, json_angle)}});
    if (rows[i].beta_rad) json.back()["beta_deg"] = json_angle(*rows[i].beta_rad);
  }
  return json;
}

}  // namespace sweepd
