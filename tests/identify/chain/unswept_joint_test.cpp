#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/judged_poses.hpp"
#include "tests/simulation/simulation.hpp"
#include "tests/simulation/truth.hpp"

using identify::Identification;
using identify::Status;
using simulation::robots::Spread;

namespace {

/// Of some arms, without the sweeps of a joint.
struct Campaigns {
  simulation::Robot robot;
  std::size_t unswept = 2;
  simulation::World world;
  simulation::Strokes strokes;
};

/// A controller's positions and angles.
simulation::World controller(int decimals) {
  simulation::World world;
  world.controller = world.angles = world.orientations = true;
  world.decimals = decimals;
  return world;
}

/// Calls `see` with what is found of each, and judges the numbers of all.
template <class See>
void judge_partial(const Campaigns& all, int count, const See& see) {
  Spread errors;
  for (int i = 1; i <= count; ++i) {
    const auto seed = static_cast<std::uint32_t>(i);
    const simulation::Simulation of(built(all.robot, seed), all.strokes, all.world, seed);
    const Identification found =
        identify::identify(simulation::robots::sweeps_without(all.unswept, of), of.campaign());
    INFO(found.reason);
    CHECK(found.status == Status::partial);
    for (const double off : simulation::errors_in_sigmas(of, found)) errors.add(off);
    see(found);
  }
  INFO("of " << errors.count << " numbers, sigma " << errors.sigma() << ", most " << errors.most);
  CHECK(errors.count >= 10 * count);
  CHECK(errors.sigma() < 1.3);
  CHECK(errors.most < 4.5);
}

}  // namespace

TEST_CASE("A joint that was not swept and stood elsewhere from sweep to sweep makes others unsure",
          "[unswept_joint][long]") {
  Campaigns all{simulation::kr5(), 2, controller(4), {}};
  all.world.wobble_deg = 0.0005;
  all.world.home.sigma_deg = GENERATE(0.0005, 0.005, 0.05);
  all.world.home.seen = true;
  judge_partial(all, 6, [](const Identification&) {});
}

TEST_CASE("Where joints that come back elsewhere stand few decimals hide",
          "[unswept_joint][long]") {
  Campaigns all{simulation::iiwa(), GENERATE(std::size_t{0}, std::size_t{4}), controller(1), {}};
  all.world.home.sigma_deg = 0.05;
  all.world.home.seen = true;
  judge_partial(all, 8, [](const Identification&) {});
}

TEST_CASE("From a home at which a joint that was not swept stands elsewhere no sweep tells",
          "[unswept_joint]") {
  Campaigns all{simulation::kr5(), 2, controller(4), {}};
  all.world.wobble_deg = 0.0005;
  all.strokes.homes = 2;
  judge_partial(all, 4, [](const Identification& found) {
    const auto told = std::find_if(found.warnings.begin(), found.warnings.end(),
                                   [](const auto& one) { return one.code == "off_home"; });
    REQUIRE(told != found.warnings.end());
    CHECK(told->joint == 2);
    CHECK(told->message ==
          "joint 3: it stood elsewhere than home in 5 sweeps of other joints, and its own axis is "
          "not known: they are left out. Sweep it, too");
  });
}
