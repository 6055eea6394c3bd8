#include "identify/chain/home_turn.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"
#include "tests/simulation/truth.hpp"

using namespace identify;
using Eigen::Index;
using simulation::Simulation;

TEST_CASE("What lies beyond a joint turns with it at home", "[home_turn]") {
  test::Random chance(2);
  const std::size_t joints = 5, targets = 2;
  Chain chain = test::random_chain(joints, targets, chance);
  const std::vector<bool> known(joints, true);
  constexpr double kStep = 1e-6;
  for (std::size_t k = 0; k < joints; ++k) {
    const Eigen::VectorXd change = by_turn_at_home(chain, k, known, targets, true);
    Turns turned{};
    turned[k] = kStep;
    for (std::size_t j = 0; j < joints; ++j) {
      Turns before{};
      if (j > k) before[k] = kStep;
      const Eigen::Isometry3d moved = chain.displacement(before);
      const auto row = static_cast<Index>(6 * j);
      const Eigen::Vector3d turns = moved.linear() * chain.axes[j].direction;
      const Eigen::Vector3d goes = moved * chain.axes[j].point_mm;
      CHECK((change.segment<3>(row) * kStep - turns + chain.axes[j].direction).norm() < 1e-11);
      CHECK((change.segment<3>(row + 3) * kStep - goes + chain.axes[j].point_mm).norm() < 1e-8);
    }
    for (std::size_t t = 0; t < targets; ++t) {
      const Eigen::Vector3d goes = chain.displacement(turned) * chain.targets_mm[t];
      const auto row = static_cast<Index>(6 * joints + 3 * t);
      CHECK((change.segment<3>(row) * kStep - goes + chain.targets_mm[t]).norm() < 1e-8);
    }
    CHECK((change.tail<3>() - chain.axes[k].direction).norm() < 1e-12);
  }
}

TEST_CASE("On which side of its play a joint stood at home is in its theta's uncertainty",
          "[home_turn][long]") {
  simulation::World world;
  world.placed = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  world.angles = true;
  world.decimals = 4;
  world.gears.backlash_arcsec = 30;
  world.gears.joint = 2;
  world.gears.play_as_left = true;
  simulation::Strokes strokes;
  strokes.there_and_back = true;
  strokes.ramp = 0.1;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const auto robot = simulation::built(simulation::kr5(), seed);
    const Simulation arm(simulation::at_random_home(robot, seed), strokes, world, seed);
    const auto found = identify::identify(arm.sweeps(), arm.campaign());
    CAPTURE(seed);
    REQUIRE(found.status == Status::complete);
    const auto truth = true_table(arm, found.dh, found.home_rad);
    for (const std::size_t j : {1U, 2U, 3U, 4U}) {
      const DhNumber& theta = found.dh[j].theta_rad;
      CAPTURE(j, theta.sigma / kArcsec);
      CHECK(std::abs(wrapped(theta.value - truth[j].theta_rad)) < 2.5 * theta.sigma);
      if (j == 2) CHECK(theta.sigma > 14 * kArcsec);
    }
  }
}
