#include "identify/poses/pose_outlook.hpp"

#include <algorithm>
#include <random>

#include "identify/identification.hpp"
#include "identify/poses/pose_design.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

/// Poses within 80 degrees of home, and what they tell.
struct Drawn {
  std::vector<std::vector<double>> angles_rad;
  std::vector<PoseRow> rows;
  std::vector<Eigen::MatrixXd> candidates;

  Drawn(const PoseForecast& forecast, const Campaign& campaign, std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<> range(-80 * kDegree, 80 * kDegree);
    for (std::size_t k = 0; k < count; ++k) {
      angles_rad.push_back(campaign.specified->home_rad);
      for (double& angle : angles_rad.back()) angle += range(random);
      rows.push_back(forecast.row(angles_rad.back()));
      candidates.push_back(forecast.candidate(rows.back()));
    }
  }

  [[nodiscard]] std::vector<PoseRow> rows_of(const std::vector<std::size_t>& chosen) const {
    std::vector<PoseRow> all;
    for (const std::size_t k : chosen) all.push_back(rows[k]);
    return all;
  }
};

PoseForecast forecast_of(const Campaign& campaign) {
  return {campaign, {.position_mm = 0.02, .orientation_rad = 0, .joint_rad = 0}};
}

}  // namespace

TEST_CASE("Uncertainties of chosen poses come out as was promised", "[pose_outlook][long]") {
  const auto arm = arm_with(tracker(), 1);
  const auto campaign = arm.campaign();
  const auto forecast = forecast_of(campaign);
  const Drawn drawn(forecast, campaign, 300);
  const auto chosen = d_optimal(drawn.candidates, 40);
  const auto promised = forecast.outlook(drawn.rows_of(chosen), drawn.rows);
  std::vector<std::vector<double>> at;
  for (const std::size_t k : chosen) at.push_back(drawn.angles_rad[k]);
  Spread ratio;
  constexpr int kRuns = 20;
  for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
    // The arm of the promise, measured by other noise.
    const simulation::Simulation measured(arm.robot(), strokes(50), tracker(), seed);
    const auto found = identify::identify({}, campaign, measured.poses_at(at));
    REQUIRE(found.status == Status::complete);
    for (std::size_t i = 0; i < found.dh.size(); ++i) {
      const auto seen = numbers_of(found.dh[i]), said = numbers_of(promised.dh[i]);
      for (std::size_t k = 0; k < seen.size(); ++k) {
        CHECK(seen[k]->knowledge == said[k]->knowledge);
        if (said[k]->knowledge == Knowledge::identified) ratio.add(seen[k]->sigma / said[k]->sigma);
      }
    }
  }
  // The noise itself is estimated, from some 90 numbers more than unknowns: to 7 %, each run.
  CHECK(ratio.sigma() > 0.9);
  CHECK(ratio.sigma() < 1.15);
}

TEST_CASE("Twelve chosen poses tell more than twelve at random", "[pose_outlook]") {
  const auto campaign = arm_with(tracker(), 2).campaign();
  const auto forecast = forecast_of(campaign);
  const Drawn drawn(forecast, campaign, 300);
  const auto chosen = forecast.outlook(drawn.rows_of(d_optimal(drawn.candidates, 12)), drawn.rows);
  int better = 0;
  constexpr int kDraws = 50;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::mt19937 random(static_cast<std::uint32_t>(draw));
    std::vector<PoseRow> some;
    std::sample(drawn.rows.begin(), drawn.rows.end(), std::back_inserter(some), 12, random);
    if (chosen.displacement_mm < forecast.outlook(some, drawn.rows).displacement_mm) ++better;
  }
  CHECK(better == kDraws);
}

TEST_CASE("A target on the last axis leaves that axis open, said beforehand", "[pose_outlook]") {
  auto campaign = arm_with(tracker(), 2).campaign();
  campaign.specified->tool_mm = {0, 0, 215};
  const auto forecast = forecast_of(campaign);
  const Drawn drawn(forecast, campaign, 60);
  const auto outlook = forecast.outlook(drawn.rows, drawn.rows);
  CHECK_FALSE(outlook.axes[5]);
  for (std::size_t j = 0; j < 5; ++j) CHECK(outlook.axes[j]);
  CHECK(outlook.dh[4].a_mm.knowledge == Knowledge::undetermined);
}

TEST_CASE("The fewest poses are those that an identification takes", "[pose_outlook]") {
  const auto built = arm_with(tracker(), 1);
  const std::size_t fewest = fewest_poses(6);
  CHECK(identify::identify({}, built.campaign(), built.poses(fewest - 1)).status == Status::failed);
  CHECK(identify::identify({}, built.campaign(), built.poses(fewest)).status != Status::failed);
}
