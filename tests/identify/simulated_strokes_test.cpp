#include <cmath>

#include "tests/catch.hpp"
#include "tests/identify/simulated_robots.hpp"
#include "tests/simulation/strokes.hpp"

using namespace simulation;
using namespace simulation::robots;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using Eigen::Vector3d;

TEST_CASE("Random homes are off the grid, and keep targets off the axes", "[simulated_strokes]") {
  for (std::uint32_t seed = 0; seed < 20; ++seed)
    for (const Robot& arm : {robot(seed, 3), at_random_home(built(iiwa(3), seed), seed)}) {
      const identify::Chain chain = chain_of(arm);
      for (std::size_t j = 0; j < arm.arm.joints(); ++j) {
        const double degrees = arm.arm.home_rad[j] / kDegree;
        CHECK(std::abs(degrees * 1e4 - std::round(degrees * 1e4)) > 1e-6);
        for (const Vector3d& target : chain.targets_mm)
          CHECK(chain.axes[j].direction.cross(target - chain.axes[j].point_mm).norm() > 80);
        CHECK(std::abs(arm.specified.rows[j].a_mm - arm.arm.rows[j].a_mm) < 3);  // six sigma
      }
    }
}

TEST_CASE("Strokes with ramps begin and end at rest, on time, and at the mean speed in between",
          "[simulated_strokes]") {
  const Stroke stroke{0, 0, {0}, -0.5, 1.5, 0, 10, false};
  CHECK(stroke.turn_at(-1, 0.1) == -0.5);
  CHECK_THAT(stroke.turn_at(11, 0.1), WithinAbs(1.5, 1e-12));
  CHECK_THAT(stroke.turn_at(5, 0.1), WithinAbs(0.5, 1e-12));
  CHECK_THAT(stroke.turn_at(0.01, 0.1) + 0.5, WithinAbs(0, 2e-5));
  CHECK_THAT((stroke.turn_at(6, 0.1) - stroke.turn_at(4, 0.1)) / 2, WithinRel(0.2 / 0.9, 1e-9));
  CHECK_THAT(stroke.turn_at(-1, 0), WithinAbs(-0.7, 1e-12));
}

TEST_CASE("Campaigns have the strokes that were asked for, in the order of time",
          "[simulated_strokes]") {
  Strokes how = strokes(5);
  how.there_and_back = true;
  how.repeats = 2;
  how.homes = 2;
  const auto homes = homes_of(how, robot(15, 3), 15);
  REQUIRE(homes.size() == 2);
  for (std::size_t k = 0; k < 6; ++k) {
    const double apart = std::abs(homes[0][k] - homes[1][k]) / kDegree;
    CHECK(apart >= 15);
    CHECK(apart <= 30);
  }
  CHECK(strokes_of(how, 6, 3).size() == 6 * 2 * 2 * 2 * 3);
  how.targets_at_once = true;
  CHECK(strokes_of(how, 6, 3).size() == 6 * 2 * 2 * 2);
  const auto sweeps = Simulation(robot(15, 3), how, exact_angles(), 15).sweeps();
  CHECK(sweeps.size() == 6 * 2 * 2 * 2 * 3);
  for (std::size_t s = 3; s < sweeps.size(); s += 3) {
    CHECK(sweeps[s].first().time_s > sweeps[s - 1].last().time_s);
    CHECK(sweeps[s].first().time_s == sweeps[s + 2].first().time_s);
  }
}
