#include "tests/acceptance/campaign.hpp"

#include <array>
#include <cmath>
#include <sstream>

#include "daemon/commands/replay_command.hpp"
#include "daemon/commands/simulate_command.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "tests/acceptance/acceptance.hpp"
#include "tests/catch.hpp"

namespace acceptance {

using Json = nlohmann::json;

Json replayed(const SimulatedCampaign& campaign, std::uint64_t seed) {
  const TemporaryFolder folder;
  std::ostringstream report;
  std::ostringstream errors;
  sweepd::SimulateOptions simulation;
  simulation.robot = shipped("robots/kr5_arc.toml");
  simulation.plan = shipped("plans/" + campaign.plan);
  simulation.ethernet_config = campaign.ethernet_config;
  simulation.seed = seed;
  simulation.write = folder / "simulated.pcap";
  simulation.quiet = true;
  REQUIRE(sweepd::simulate(simulation, report, errors) == 0);

  sweepd::ReplayOptions replay;
  replay.traces = {*simulation.write};
  replay.robot = simulation.robot;
  if (campaign.plan_is_known) replay.plan = simulation.plan;
  replay.output = folder / "result";
  replay.quiet = true;
  REQUIRE(sweepd::replay(replay, report, errors) == 0);
  CHECK(errors.str().empty());
  return Json::parse(text_of(folder / "result/result.json"));
}

std::vector<Json> replayed(const SimulatedCampaign& campaign) {
  std::vector<Json> results;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) results.push_back(replayed(campaign, seed));
  return results;
}

std::vector<Deviation> deviations(const std::vector<Json>& results) {
  constexpr std::array<std::array<const char*, 2>, 4> kNumbers{{{"b_mm", "b_sigma_mm"},
                                                                {"theta_deg", "theta_sigma_deg"},
                                                                {"a_mm", "a_sigma_mm"},
                                                                {"alpha_deg", "alpha_sigma_deg"}}};
  std::vector<Deviation> all;
  for (const auto& [name, sigma_name] : kNumbers)
    for (std::size_t j = 0; j < 6; ++j) {
      Deviation deviation{name, j + 1};
      for (const Json& result : results) {
        if (result["difference"][j][name].is_null()) continue;
        const double error = std::abs(result["difference"][j][name].get<double>());
        const double sigma = result["dh"][j][sigma_name];
        deviation.squares += error * error / (sigma * sigma);
        if (error < deviation.worst) continue;
        deviation.worst = error;
        deviation.sigma = sigma;
      }
      if (deviation.sigma > 0) all.push_back(deviation);
    }
  return all;
}

double chi(const std::vector<Deviation>& deviations) {
  double squares = 0;
  for (const auto& deviation : deviations) squares += deviation.squares;
  return std::sqrt(squares / static_cast<double>(deviations.size() * kSeeds));
}

void check_within(const std::vector<Json>& results, const Bounds& bounds) {
  CHECK(results.size() == kSeeds);
  const std::vector<std::string> all{"b_mm", "theta_deg", "a_mm", "alpha_deg"};
  for (const Json& result : results) {
    CHECK(result["status"] == "complete");
    for (std::size_t j = 0; j < 6; ++j) {
      INFO("row " << j + 1);
      // b along parallel axes, and the frame on the end-effector.
      const auto expected = j == 1   ? std::vector<std::string>{"b_mm"}
                            : j == 5 ? all
                                     : std::vector<std::string>{};
      CHECK(result["dh"][j].value("by_convention", std::vector<std::string>{}) == expected);
    }
  }
  for (const auto& deviation : deviations(results)) {
    INFO("row " << deviation.joint);
    if (deviation.name == "b_mm") CHECK(deviation.worst <= bounds.b_mm);
    if (deviation.name == "a_mm") CHECK(deviation.worst <= bounds.a_mm);
    if (deviation.name == "alpha_deg") CHECK(deviation.worst <= bounds.alpha_deg);
  }
}

void check_strokes(const Json& result, const std::string& plan_file) {
  const auto plan = sweepd::load_plan(shipped("plans/" + plan_file));
  REQUIRE(plan.sweeps.size() == 6);
  for (const auto& planned : plan.sweeps) {
    INFO("joint " << planned.joint);
    const double home = plan.home_deg[planned.joint - 1];
    const std::array<double, 4> stops{home, planned.start_deg, planned.end_deg, home};
    // A sweep that begins or ends at home is not told from a way there: both are used.
    const bool has_ways = planned.start_deg != home && planned.end_deg != home;
    const Json& found = result["joints"][planned.joint - 1]["sweeps"];
    std::size_t s = 0;
    for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
      const double turn = stops[k + 1] - stops[k];
      if (turn == 0) continue;
      REQUIRE(s < found.size());
      const Json& stroke = found[s++];
      CHECK(stroke["direction"] == (turn > 0 ? 1 : -1));
      // The ends of the ramps, 0.05 % of a stroke, are cut off.
      CHECK(stroke["range_deg"].get<double>() == Approx(std::abs(turn)).epsilon(0.002));
      CHECK(stroke.value("positioning", false) == (has_ways && k != 1));
      CHECK(stroke["used"] == !(has_ways && k != 1));
    }
    CHECK(s == found.size());
  }
}

}  // namespace acceptance
