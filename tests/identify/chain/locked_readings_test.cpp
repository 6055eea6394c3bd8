#include "identify/chain/locked_readings.hpp"

#include <cmath>
#include <cstdint>

#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"
#include "tests/identify/simulated_robots.hpp"
#include "tests/simulation/truth.hpp"

using namespace identify;
using simulation::Simulation;

TEST_CASE("Joints that shake by less than their last decimal leave no noise but their own",
          "[locked_readings]") {
  simulation::World world;
  world.controller = world.orientations = world.angles = true;
  world.decimals = 2;
  world.wobble_deg = 0.0005;
  simulation::robots::Spread errors;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const auto robot = simulation::built(simulation::iiwa(), seed);
    const Simulation arm(simulation::at_random_home(robot, seed), {}, world, seed);
    const auto found = identify::identify(arm.sweeps(), arm.campaign());
    CAPTURE(seed);
    REQUIRE(found.status == Status::complete);
    for (const AngleEvidence& joint : found.chain->angles)
      CHECK(joint.trust == AngleTrust::trusted);
    for (const double error : errors_in_sigmas(arm, found)) errors.add(error);
  }
  CHECK(errors.count >= 6 * 20);
  CHECK(errors.sigma() < 1.3);
  CHECK(errors.most < 4.5);
}

TEST_CASE("Of a locked joint's readings the share counts that the target follows",
          "[locked_readings]") {
  test::Random random(5);
  const std::size_t joints = 4, shaken = 1;
  const Chain chain = test::random_chain(joints, 1, random);
  test::Measured how;
  how.position_mm = 0.02;
  how.locked_rad = 6e-6;  // and the joints themselves ten times as much
  how.samples = 400;
  auto all = test::sweeps_of(chain, how, random);
  for (ChainObservation& seen : all)
    if (seen.joint != shaken) seen.turns[shaken] += random.normal(3 * 10 * how.locked_rad);
  const ChainNodes told = test::nodes_of(all, joints);
  ChainNodes nodes = told;
  const auto noise = test::noise_of(chain, how, true);
  const double step_rad = 2e-4;
  CHECK_FALSE(discount_readings(nodes, chain, noise, 0));
  CHECK_FALSE(discount_readings(nodes, chain, noise, step_rad / 100));
  REQUIRE(discount_readings(nodes, chain, noise, step_rad));
  for (std::size_t s = 0; s < nodes.strokes.size(); ++s) {
    const StrokeMoments& stroke = nodes.strokes[s];
    const auto begin = static_cast<Eigen::Index>(stroke.content.orientation ? 7 : 4);
    for (std::size_t k = 0; k < joints; ++k) {
      if (k == stroke.content.joint) continue;
      CAPTURE(s, k);
      const auto at = begin + static_cast<Eigen::Index>(k);
      double before = 0, after = 0;
      for (std::size_t n = 0; n < stroke.nodes.size(); ++n) {
        before += told.strokes[s].nodes[n].sums(at, at);
        after += stroke.nodes[n].sums(at, at);
      }
      // Of the shaken joint's variance a tenth is the joint's own, of the others' all but a 101st.
      if (k == shaken)
        CHECK(std::sqrt(after / before) == Approx(0.1).margin(0.06));
      else
        CHECK(std::sqrt(after / before) > 0.95);
    }
  }
}
