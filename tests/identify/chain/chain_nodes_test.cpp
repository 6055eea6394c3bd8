#include "identify/chain/chain_nodes.hpp"

#include <algorithm>
#include <utility>

#include "tests/catch.hpp"
#include "tests/identify/simulated_robots.hpp"
#include "tests/simulation/simulation.hpp"

using namespace identify;

namespace {

ChainNodes nodes_of_sweeps(const simulation::Strokes& how) {
  simulation::World world;
  world.angles = true;
  const simulation::Simulation campaign(simulation::kr5(), how, world, 1);
  std::vector<StrokeMoments> strokes;
  for (const Sweep& sweep : campaign.sweeps())
    strokes.push_back(moments_of(sweep, {*sweep.joint, 6, false}).value());
  const std::vector<double>& home = campaign.robot().arm.home_rad;
  return nodes_of(std::move(strokes), {home.begin(), home.end()}, std::vector<bool>(6, true));
}

}  // namespace

TEST_CASE("a joint rests from one of its sweeps to the next one, or until all go elsewhere",
          "[chain_nodes]") {
  simulation::Strokes how;
  how.samples = 30;
  how.there_and_back = true;
  how.rounds = 2;
  how.homes = 2;
  const ChainNodes nodes = nodes_of_sweeps(how);
  REQUIRE(nodes.homes.size() == 2);
  REQUIRE(nodes.units.size() == 48);

  // Each but the last joint before its first round's sweep or after, between, and after its last.
  REQUIRE(nodes.rests.size() == 2);
  for (const auto& whose : nodes.rests)
    for (std::size_t joint = 0; joint < 6; ++joint)
      CHECK(std::count(whose.begin(), whose.end(), joint) == (joint == 0 || joint == 5 ? 2 : 3));
  CHECK(nodes.most_rests() == 16);

  const auto rest = [&](int round, std::size_t sweeping, bool back, std::size_t joint) {
    return nodes
        .rest_of[static_cast<std::size_t>(round) * 12 + 2 * sweeping + (back ? 1 : 0)][joint];
  };
  CHECK_FALSE(rest(0, 2, false, 2));
  CHECK(rest(0, 0, false, 2) == rest(0, 1, true, 2));
  CHECK(rest(0, 1, true, 2) != rest(0, 3, false, 2));
  CHECK(rest(0, 3, false, 2) == rest(1, 1, true, 2));
  CHECK(rest(1, 1, true, 2) != rest(1, 3, false, 2));
  CHECK(rest(0, 3, false, 2) != rest(0, 3, false, 1));
}

TEST_CASE("where times begin anew with each sweep, nobody knows what has rested", "[chain_nodes]") {
  simulation::Strokes how;
  how.samples = 30;
  how.rest_s = -100;
  CHECK(nodes_of_sweeps(how).most_rests() == 0);
}
