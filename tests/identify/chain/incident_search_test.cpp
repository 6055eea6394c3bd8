#include "identify/chain/incident_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"
#include "tests/simulation/simulation.hpp"
#include "tests/simulation/truth.hpp"

using namespace identify;
using identify::test::find_warning;
using simulation::Simulation;

namespace {

/// By a device of 0.02 mm some metres away.
simulation::World by_device() {
  simulation::World world;
  world.angles = world.placed = true;
  world.decimals = 4;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  return world;
}

simulation::Robot some_palletizer(std::uint32_t seed) {
  return simulation::at_random_home(simulation::built(simulation::palletizer(), seed), seed);
}

bool inside(const Simulation& campaign, const Identification& found) {
  const auto errors = simulation::errors_in_sigmas(campaign, found);
  return !errors.empty() &&
         std::all_of(errors.begin(), errors.end(), [](double z) { return std::abs(z) < 4.5; });
}

Simulation palletizer_campaign(std::uint32_t seed) {
  simulation::Strokes how;
  how.samples = 200;
  how.there_and_back = true;
  return Simulation(some_palletizer(seed), how, by_device(), seed);
}

/// What the device saw went `mm` away during the first sweep of a joint.
std::vector<Sweep> with_disturbed(const Simulation& campaign, std::size_t joint, double mm) {
  bool once = true;
  return test::changed(campaign.sweeps(), [&](const Sweep& sweep, std::vector<Sample>& samples) {
    if (*sweep.joint != joint || !std::exchange(once, false)) return;
    const auto count = static_cast<double>(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i].position_mm +=
          mm * static_cast<double>(i) / count * Eigen::Vector3d(0.6, -0.7, 0.4);
  });
}

}  // namespace

TEST_CASE("What joints that stay off home explain as well as a moved device is uncertain",
          "[incident_search][long]") {
  const double mm = GENERATE(0.1, 0.4);
  simulation::Strokes how;
  how.samples = 200;
  how.there_and_back = GENERATE(true, false);
  CAPTURE(mm, how.there_and_back);
  simulation::World world = by_device();
  world.drift.moved_mm = mm;
  int told = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Simulation campaign(some_palletizer(seed), how, world, seed);
    const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
    CAPTURE(seed, found.reason);
    if (found.status != Status::complete) {
      // Turned with it, the target was moved by more than the model has.
      REQUIRE_FALSE(found.doubts.empty());
      const auto& code = found.doubts.front().code;
      CHECK((code == "device_moved" || code == "off_home"));
      ++told;
      continue;
    }
    CHECK(inside(campaign, found));
    REQUIRE(found.chain);
    if (found.chain->move || find_warning(found, "other_explanation")) ++told;
  }
  // Sweeps one way are less certain: there it would change little.
  if (how.there_and_back) CHECK(told >= 6);
}

TEST_CASE("A disturbed sweep is told with its joint", "[incident_search][long]") {
  const Simulation campaign = palletizer_campaign(1);
  const auto found = identify::identify(with_disturbed(campaign, 2, 3), campaign.campaign());
  const Warning* told = find_warning(found, "sweep_disturbed");
  REQUIRE(told);
  CHECK(told->joint == 2);
}

TEST_CASE("A disturbed sweep is found where homes that are off explain it, too",
          "[incident_search][long]") {
  const double mm = GENERATE(1.0, 3.0);
  int told = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Simulation campaign = palletizer_campaign(seed);
    const auto found =
        identify::identify(with_disturbed(campaign, seed % 4, mm), campaign.campaign());
    CAPTURE(seed, mm, found.reason);
    if (find_warning(found, "sweep_disturbed")) ++told;
    if (found.status == Status::complete) CHECK(inside(campaign, found));
  }
  CHECK(told >= 7);
}

TEST_CASE("Joints that stay off home are no device that was moved", "[incident_search][long]") {
  simulation::World world = by_device();
  world.home.sigma_deg = 0.005;
  world.home.lasts = HomeLasts::stand;
  simulation::Strokes how;
  how.samples = 200;
  how.there_and_back = true;
  int moved = 0;
  for (std::uint32_t seed = 1; seed <= 16; ++seed) {
    const Simulation campaign(
        simulation::at_random_home(simulation::built(simulation::kr5(), seed), seed), how, world,
        seed);
    const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
    REQUIRE(found.chain);
    if (found.chain->move) ++moved;
  }
  CHECK(moved <= 1);
}
