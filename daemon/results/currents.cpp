#include "daemon/results/json_parts.hpp"
#include "daemon/results/result_formats.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

constexpr int kCurrentDecimals = 4;
constexpr double kMiddleOfDegree = 0.5;  // of a degree that is rounded down

void append_mean(std::string& csv, const JointCurrents::Mean& mean) {
  csv += ',';
  if (mean.count > 0) append_fixed(csv, mean.value(), kCurrentDecimals);
}

}  // namespace

std::string currents_csv(const Outcome& outcome) {
  std::string csv = "joint,angle_deg,rising_a,falling_a,rising_samples,falling_samples\n";
  for (std::size_t j = 0; j < outcome.currents.size(); ++j)
    for (const auto& [degree, place] : outcome.currents[j].places) {
      csv += std::to_string(j + 1) + ',';
      append_fixed(csv, degree + kMiddleOfDegree, 1);
      append_mean(csv, place.rising);
      append_mean(csv, place.falling);
      csv += ',' + std::to_string(place.rising.count) + ',' + std::to_string(place.falling.count) +
             '\n';
    }
  return csv;
}

nlohmann::ordered_json currents_json(const Outcome& outcome) {
  auto json = nlohmann::ordered_json::array();
  for (std::size_t j = 0; j < outcome.currents.size(); ++j) {
    const JointCurrents::Joint& joint = outcome.currents[j];
    if (joint.places.empty()) continue;
    const auto friction = joint.friction();
    json.push_back({{"joint", j + 1}, {"speed_deg_s", rounded(joint.speed_deg_s.value(), 2)}});
    json.back()["places"] = friction.places;
    if (friction.places == 0) continue;
    json.back()["friction_a"] = rounded(friction.mean, kCurrentDecimals);
    json.back()["scatter_a"] = rounded(friction.scatter, kCurrentDecimals);
  }
  return json;
}

}  // namespace sweepd
