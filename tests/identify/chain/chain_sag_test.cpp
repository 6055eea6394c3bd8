#include "identify/chain/chain_sag.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"
#include "tests/simulation/simulation.hpp"
#include "tests/simulation/truth.hpp"

using namespace identify;
using simulation::Simulation;

namespace {

/// How the estimates' errors compare with what is stated, all identified lengths and angles.
double rms_z(const std::vector<Simulation>& campaigns) {
  double squares = 0, count = 0;
  for (const Simulation& campaign : campaigns) {
    const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
    const auto truth = simulation::true_table(campaign, found.dh, found.home_rad);
    REQUIRE(found.estimator == Estimator::chain);
    for (std::size_t i = 0; i < found.dh.size(); ++i)
      for (const auto& [number, actual] :
           {std::pair(found.dh[i].a_mm, truth[i].a_mm), std::pair(found.dh[i].b_mm, truth[i].b_mm),
            std::pair(found.dh[i].alpha_rad, truth[i].alpha_rad)}) {
        if (number.knowledge != Knowledge::identified) continue;
        const double z = (number.value - actual) / number.sigma;
        squares += z * z;
        ++count;
      }
  }
  return std::sqrt(squares / count);
}

std::vector<Simulation> sagging(bool told) {
  simulation::World world;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  world.placed = true;
  world.sag_arcsec = 60;
  world.sag_told = told;
  simulation::Strokes how;
  how.arc_deg = 90;
  how.samples = 300;
  std::vector<Simulation> all;
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U})
    all.emplace_back(simulation::at_random_home(simulation::built(simulation::kr5(), seed), seed),
                     how, world, seed);
  return all;
}

}  // namespace

TEST_CASE("A load's lever is how fast it rises as the joint turns", "[chain_sag]") {
  test::Random chance(1);
  Chain chain = test::random_chain(6, 1, chance);
  const std::vector<bool> known(6, true);
  chain.sags = sags_of(chain, known, {0, 1, 1, 0, 0, 1});
  REQUIRE(chain.sags.size() == 5 + 4 + 1);
  Turns turns{};
  for (std::size_t j = 1; j < 6; ++j) turns[j] = chance.uniform(-1, 1);
  const Eigen::Vector3d up = chain.axes.front().direction;
  constexpr double kStep = 1e-6;
  const auto levers = sag_levers(chain, turns);
  for (std::size_t s = 0; s < chain.sags.size(); ++s) {
    const ChainSag& sag = chain.sags[s];
    if (sag.load < 6) continue;
    const auto rise = [&](Turns from) {
      Turns more = from;
      more[sag.joint] += kStep;
      from[sag.joint] -= kStep;
      return up.dot(chain.target_mm(0, more) - chain.target_mm(0, from)) / (2 * kStep);
    };
    CHECK(levers[s] == Approx((rise(turns) - rise({})) / sag.reach_mm).margin(1e-8));
  }
}

TEST_CASE("What joints give way by is shared out so that it is what the description says",
          "[chain_sag]") {
  test::Random chance(2);
  const Chain chain = test::random_chain(6, 1, chance);
  const auto sags = sags_of(chain, std::vector<bool>(6, true), {0, 0.1, 0, 0, 0, 0});
  double squares = 0;
  for (const ChainSag& sag : sags) squares += sag.sigma_rad * sag.sigma_rad;
  CHECK(std::sqrt(squares) == Approx(0.1));
  CHECK(sags_of(chain, std::vector<bool>(6, false), {0, 0.1, 0, 0, 0, 0}).empty());
  CHECK(sags_of(chain, std::vector<bool>(6, true), {}).empty());
}

TEST_CASE("Uncertainties hold for an arm that sags as its description says", "[chain_sag]") {
  CHECK(rms_z(sagging(false)) > 2);
  CHECK(rms_z(sagging(true)) < 1.3);
}

TEST_CASE("The budget says what sag has of the uncertainties", "[chain_sag]") {
  const auto campaign = sagging(true).front();
  const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
  double sag = 0, all = found.dh_covariance.trace();
  for (const auto& share : found.dh_budget)
    if (share.cause == Cause::sag) sag = share.variances.sum();
  CHECK(found.chain->effects.sag_rad == Approx(60 * kArcsec));
  CHECK(sag > 0.1 * all);
  CHECK(sag < all);
}
