
#include <cmath>

#include <nlohmann/json.hpp>

#include "daemon/results/json_parts.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using identify::AngleEvidence;

Json noise(const identify::ChainEstimate& estimate) {
  Json swept = Json::array();
  for (const double sigma : estimate.noise.swept_rad)
    swept.push_back(std::isfinite(sigma) ? json_angle(sigma) : Json());
  return {{"position_mm", json_length(estimate.noise.position_mm)},
          {"locked_deg", json_angle(estimate.noise.locked_rad)},
          {"swept_deg", std::move(swept)},
          {"orientation_deg",
           estimate.with_orientation ? json_angle(estimate.noise.orientation_rad) : Json()}};
}

Json effects(const identify::ChainEstimate& estimate) {
  const identify::ChainEffects& seen = estimate.effects;
  return {{"home_deg", json_angle(seen.home_rad)},
          {"home_stays", seen.home_lasts != identify::HomeLasts::stroke},
          {"home_lasts", text(seen.home_lasts)},
          {"creep_deg", json_angle(seen.creep_rad)},
          {"drift_mm", json_length(estimate.wander_mm)},
          {"figure_mm", json_length(seen.figure_mm())},
          {"offset_deg", json_angle(seen.offset_rad)},
          {"sag_deg", json_angle(seen.sag_rad)}};
}

/// What has `mm` and its `covariance`.
template <class Shift>
Json shift(const Shift& seen) {
  Json mm = Json::array(), sigma = Json::array();
  for (Eigen::Index k = 0; k < 3; ++k) {
    mm.push_back(json_length(seen.mm(k)));
    sigma.push_back(json_length(std::sqrt(seen.covariance(k, k))));
  }
  return {{"mm", std::move(mm)}, {"sigma_mm", std::move(sigma)}};
}

Json steady_drift(const identify::ChainEstimate::SteadyDrift& seen) {
  Json json = shift(seen);
  json["seconds"] = seen.seconds > 0 ? Json(rounded(seen.seconds, 3)) : Json();
  return json;
}

Json move(const identify::ChainEstimate::MoveSeen& seen) {
  Json json = shift(seen);
  json["joint"] = seen.joint + 1;
  return json;
}

Json strays(const std::vector<identify::ChainEstimate::StraySweep>& seen) {
  Json json = Json::array();
  for (const auto& one : seen)
    json.push_back(
        {{"joint", one.joint + 1}, {"sweep", one.number + 1}, {"mm", json_length(one.mm)}});
  return json;
}

Json others(const std::vector<identify::ChainEstimate::OtherExplanation>& seen) {
  Json json = Json::array();
  for (const auto& one : seen)
    json.push_back({{"what", one.moved ? "moved" : "disturbed"},
                    {"joint", one.joint + 1},
                    {"sweep", one.number + 1},
                    {"mm", json_length(one.mm)}});
  return json;
}

/// Of a linear joint its ways: mm.
Json ways(Json json, const AngleEvidence& seen) {
  json["error_rms_mm"] = json_angle(seen.error_rms_rad);
  json["remainder_rms_mm"] = json_angle(seen.remainder_rms_rad);
  json["expected_rms_mm"] = json_angle(seen.expected_rms_rad);
  json["size"] = rounded(seen.size, 3);
  json["coherence"] = rounded(seen.coherence, 3);
  json["remainder_coherence"] = rounded(seen.remainder_coherence, 3);
  json["curve"] = {{"offset_mm", json_angle(seen.curve[0])},
                   {"scale_ppm", rounded(1e6 * seen.curve[1], kArcsecDecimals)},
                   {"cos1_mm", json_angle(seen.curve[2])},
                   {"sin1_mm", json_angle(seen.curve[3])},
                   {"cos2_mm", json_angle(seen.curve[4])},
                   {"sin2_mm", json_angle(seen.curve[5])}};
  const bool both_ways = seen.backlash_sigma_rad > 0;
  json["backlash_mm"] = both_ways ? json_angle(seen.backlash_rad) : Json();
  json["backlash_sigma_mm"] = both_ways ? json_angle(seen.backlash_sigma_rad) : Json();
  return json;
}

Json angles(std::size_t index, const AngleEvidence& seen, bool linear) {
  Json json = {{"joint", index + 1},
               {"trust", identify::text(seen.trust)},
               {"reason", seen.reason},
               {"samples", seen.samples}};
  if (seen.samples == 0) return json;
  if (linear) return ways(std::move(json), seen);
  json["error_rms_arcsec"] = json_arcsec(seen.error_rms_rad);
  json["remainder_rms_arcsec"] = json_arcsec(seen.remainder_rms_rad);
  json["expected_rms_arcsec"] = json_arcsec(seen.expected_rms_rad);
  json["size"] = rounded(seen.size, 3);
  json["coherence"] = rounded(seen.coherence, 3);
  json["remainder_coherence"] = rounded(seen.remainder_coherence, 3);
  json["curve"] = {{"offset_arcsec", json_arcsec(seen.curve[0])},
                   {"scale_ppm", rounded(1e6 * seen.curve[1], kArcsecDecimals)},
                   {"cos1_arcsec", json_arcsec(seen.curve[2])},
                   {"sin1_arcsec", json_arcsec(seen.curve[3])},
                   {"cos2_arcsec", json_arcsec(seen.curve[4])},
                   {"sin2_arcsec", json_arcsec(seen.curve[5])}};
  const bool both_ways = seen.backlash_sigma_rad > 0;
  json["backlash_arcsec"] = both_ways ? json_arcsec(seen.backlash_rad) : Json();
  json["backlash_sigma_arcsec"] = both_ways ? json_arcsec(seen.backlash_sigma_rad) : Json();
  return json;
}

}  // namespace

Json chain_json(const identify::ChainEstimate& estimate) {
  const auto& summary = estimate.summary;
  Json evidence = Json::array();
  for (std::size_t j = 0; j < estimate.angles.size(); ++j)
    evidence.push_back(angles(j, estimate.angles[j], estimate.chain.axes[j].linear));
  return {{"summary",
           {{"converged", summary.converged},
            {"ending", summary.ending},
            {"iterations", summary.iterations},
            {"cost", rounded(summary.cost, 3)},
            {"condition", rounded(summary.condition, 0)},
            {"undetermined", summary.undetermined}}},
          {"samples", estimate.samples},
          {"outliers", estimate.outliers},
          {"samples_per_independent", rounded(estimate.samples_per_independent, 3)},
          {"shared_home", estimate.home_scatter_mm <= identify::kHomeScatter_mm},
          {"home_scatter_mm", json_length(estimate.home_scatter_mm)},
          {"effects", effects(estimate)},
          {"steady_drift", estimate.steady_drift ? steady_drift(*estimate.steady_drift) : Json()},
          {"move", estimate.move ? move(*estimate.move) : Json()},
          {"disturbed_sweeps", strays(estimate.strays)},
          {"other_explanations", others(estimate.others)},
          {"with_orientation", estimate.with_orientation},
          {"noise", noise(estimate)},
          {"angles", std::move(evidence)}};
}

}  // namespace sweepd
