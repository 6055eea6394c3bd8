#include "identify/chain/delay.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/chain/chain_start.hpp"
#include "identify/circle/circle_estimator.hpp"
#include "identify/sweeps/segmentation.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_robots.hpp"
#include "tests/simulation/printed.hpp"
#include "tests/simulation/program.hpp"
#include "tests/simulation/simulation.hpp"
#include "tests/simulation/truth.hpp"

using namespace identify;
using simulation::Simulation;
using simulation::Strokes;
using simulation::World;

namespace {

World tracker_with_angles(double late_s) {
  World world;
  world.angles = world.placed = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  world.delay.late_s = late_s;
  return world;
}

Strokes both_ways(double ramp) {
  Strokes strokes;
  strokes.there_and_back = true;
  strokes.ramp = ramp;
  return strokes;
}

std::optional<Delay> found_in(const Simulation& simulation) {
  const auto circles = estimate_circles(simulation.sweeps(), simulation.campaign());
  return find_delay(circles, starting_axes(circles), simulation.campaign());
}

bool accuses_gears(const Identification& found) {
  return std::any_of(found.warnings.begin(), found.warnings.end(), [](const Warning& warning) {
    return warning.code == "backlash" || warning.code == "transmission_error";
  });
}

/// What a controller tells of a program, from cycle to cycle, its angles so late.
std::vector<Sweep> told(const simulation::Robot& robot, const simulation::Program& program,
                        double cycle_s, int decimals, double late_s = 0) {
  const auto chain = simulation::chain_of(robot);
  Segmenter segmenter(robot.arm.joints());
  segmenter.set_resolution(
      {simulation::print_step(decimals), simulation::print_step(decimals) * kDegree});
  std::vector<Sweep> sweeps;
  const auto take = [&](std::vector<Sweep> ended) {
    for (Sweep& sweep : ended) sweeps.push_back(std::move(sweep));
  };
  for (int i = 0; cycle_s * i < program.seconds(); ++i) {
    Sample sample;
    sample.time_s = cycle_s * i;
    sample.angles_rad = program.angles_rad(std::max(0.0, sample.time_s - late_s));
    sample.joints = static_cast<std::uint8_t>(robot.arm.joints());
    const auto now = program.angles_rad(sample.time_s);
    Turns turns{};
    for (std::size_t j = 0; j < robot.arm.joints(); ++j) {
      turns[j] = now[j] - robot.arm.home_rad[j];
      sample.angles_rad[j] =
          simulation::printed(sample.angles_rad[j] / kDegree, decimals) * kDegree;
    }
    sample.position_mm = chain.target_mm(0, turns);
    for (double& mm : sample.position_mm) mm = simulation::printed(mm, decimals);
    sample.has_position = true;
    take(segmenter.push(sample));
  }
  take(segmenter.finish());
  return sweeps;
}

Campaign campaign_of(const simulation::Robot& robot, int decimals) {
  Campaign campaign;
  campaign.joints = robot.arm.joints();
  campaign.specified = robot.specified;
  campaign.resolution = {simulation::print_step(decimals),
                         simulation::print_step(decimals) * kDegree};
  return campaign;
}

simulation::Robot some_robot(bool seven, std::uint32_t seed) {
  return simulation::at_random_home(
      simulation::built(seven ? simulation::iiwa() : simulation::kr5(), seed), seed);
}

/// What one decimal tells of sweeps one way at 10 degrees a second whose angles come late.
Identification found_of_late(const simulation::Robot& robot, double late_s, double half_deg,
                             double rest_s, double cycle_s) {
  constexpr int kDecimals = 1;
  simulation::Program program(robot.arm.home_rad);
  program.rest(1);
  for (std::size_t j = 0; j < robot.arm.joints(); ++j) program.sweep(j, half_deg, 10, rest_s);
  return identify::identify(told(robot, program, cycle_s, kDecimals, late_s),
                            campaign_of(robot, kDecimals));
}

}  // namespace

TEST_CASE("a delay is found to 0.1 ms and within its uncertainty, and no gear is accused of it",
          "[delay][long]") {
  const auto late_s = GENERATE(0.0, 0.004, 0.1, 0.5, -0.02);
  const auto ramp = GENERATE(0.0, 0.1);
  const auto seven = GENERATE(false, true);
  CAPTURE(late_s, ramp, seven);
  double squares = 0;
  constexpr std::uint32_t kRuns = 6;
  for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
    CAPTURE(seed);
    const Simulation simulation(some_robot(seven, seed), both_ways(ramp),
                                tracker_with_angles(late_s), seed);
    const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
    REQUIRE(found.delay);
    CHECK(std::abs(found.delay->late_s - late_s) < 1e-4);
    CHECK(found.delay->rate == 0);
    squares += std::pow((found.delay->late_s - late_s) / found.delay->sigma_s, 2);
    CHECK(is_significant(*found.delay) == (late_s != 0));
    for (const Warning& warning : found.warnings)
      UNSCOPED_INFO(warning.code << ": " << warning.message);
    CHECK_FALSE(accuses_gears(found));
  }
  CHECK(std::sqrt(squares / kRuns) < 1.8);
}

TEST_CASE("a linear unit whose sweeps begin elsewhere each time makes no delay and no backlash",
          "[delay][effect_sizes][long]") {
  double squares = 0;
  constexpr std::uint32_t kRuns = 8;
  for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
    CAPTURE(seed);
    World world = tracker_with_angles(0);
    world.home.sigma_deg = 0.005;
    Strokes strokes = both_ways(0);
    strokes.ranges_deg.assign(7, {-45, 45});
    strokes.ranges_deg[0] = {-150, 150};  // mm
    strokes.times_as_fast = {5, 1, 1, 1, 1, 1, 1};
    const Simulation simulation(simulation::built(simulation::kr5_on_rail(), seed), strokes, world,
                                seed);
    const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
    REQUIRE(found.delay);
    squares += std::pow(found.delay->late_s / found.delay->sigma_s, 2);
    CHECK_FALSE(accuses_gears(found));
  }
  CHECK(std::sqrt(squares / kRuns) < 1.8);
}

TEST_CASE("stamps that are printed with few decimals make no delay of even sweeps one way",
          "[delay][long]") {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    World world = tracker_with_angles(0);
    world.decimals = world.time_decimals = 4;
    world.noise.range_mm = world.noise.across_mm = 0.005;
    Strokes strokes;
    for (int joint = 0; joint < 6; ++joint)
      strokes.ranges_deg.push_back({-20.0 - joint, 25.0 + 2 * joint + 0.7 * seed});
    const Simulation simulation(some_robot(false, seed), strokes, world, seed);
    const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
    CHECK_FALSE(found.delay);
    CHECK_FALSE(accuses_gears(found));
  }
}

TEST_CASE("a delay is taken out of the sweeps from every home, and accuses no gear",
          "[delay][long]") {
  const auto late_s = GENERATE(0.1, 0.5);
  CAPTURE(late_s);
  Strokes strokes = both_ways(0.1);
  strokes.homes = 2;
  const Simulation simulation(some_robot(false, 3), strokes, tracker_with_angles(late_s), 3);
  const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
  REQUIRE(found.delay);
  CHECK(found.delay->late_s == Approx(late_s).margin(1e-4));
  CHECK_FALSE(accuses_gears(found));
  REQUIRE(found.chain);
  for (const AngleEvidence& angles : found.chain->angles) {
    CHECK(angles.trust != AngleTrust::free);
    // All joints' play hangs on how late the angles are.
    CHECK(std::abs(angles.backlash_rad) < 4 * angles.backlash_sigma_rad);
  }
}

TEST_CASE("what is said of play knows how uncertain a delay is", "[delay][long]") {
  double squares = 0;
  int count = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    Strokes strokes = both_ways(0.1);
    strokes.samples = 1500;
    strokes.speed_deg_s = 60;
    const Simulation simulation(some_robot(false, seed), strokes, tracker_with_angles(0.1), seed);
    const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
    REQUIRE(found.chain);
    for (const AngleEvidence& angles : found.chain->angles) {
      squares += std::pow(angles.backlash_rad / angles.backlash_sigma_rad, 2);
      ++count;
    }
  }
  CHECK(std::sqrt(squares / count) < 1.5);
}

TEST_CASE("gears that err and outliers do not pass for a delay", "[delay]") {
  const auto seed = GENERATE(1U, 2U, 3U);
  auto world = tracker_with_angles(0.1);
  world.gears = {20, 10, 30, {}};
  world.noise.outlier_share = 0.1;
  const auto delay = found_in(Simulation(some_robot(false, seed), both_ways(0.1), world, seed));
  REQUIRE(delay);
  // 30 arcsec at 20 degrees a second are 0.4 ms, in each joint by another share.
  CHECK(std::abs(delay->late_s - 0.1) < 3 * delay->sigma_s);
  CHECK(delay->sigma_s < 2e-4);
}

TEST_CASE("clocks that differ make the delay grow", "[delay][long]") {
  const auto seed = GENERATE(1U, 2U, 3U);
  auto world = tracker_with_angles(0.1);
  world.delay.rate_ppm = 50;
  const Simulation simulation(some_robot(false, seed), both_ways(0.1), world, seed);
  const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
  REQUIRE(found.delay);
  CHECK(found.delay->rate == Approx(50e-6).margin(2e-6));
  CHECK(std::abs(found.delay->late_s - 0.1 - 50e-6 * found.delay->at_s) < 1e-4);
  CHECK_FALSE(accuses_gears(found));
}

TEST_CASE("one way at one speed tells no delay", "[delay]") {
  const auto seed = GENERATE(1U, 2U, 3U);
  const auto decimals = GENERATE(1, 4);
  auto world = tracker_with_angles(0.05);
  world.decimals = decimals;
  CHECK_FALSE(found_in(Simulation(some_robot(false, seed), {}, world, seed)));
}

TEST_CASE("one way, a delay is told by how joints get to speed and stop", "[delay]") {
  const auto late_s = GENERATE(0.0, 0.02, 0.04, 0.3);
  const auto seed = GENERATE(1U, 2U);
  CAPTURE(late_s, seed);
  Strokes strokes;
  strokes.ramp = 0.03;
  strokes.repeats = 2;
  const auto found =
      found_in(Simulation(some_robot(false, seed), strokes, tracker_with_angles(late_s), seed));
  REQUIRE(found);
  CHECK(std::abs(found->late_s - late_s) < 1e-4);
  CHECK(std::abs(found->late_s - late_s) < 3 * found->sigma_s);
  CHECK(is_significant(*found) == (late_s != 0));
}

TEST_CASE(
    "angles that go on by whole steps of their print make no delay of how joints get to speed",
    "[delay][issue12][long]") {
  // So many steps a cycle: 24, 40, 400; and 480, where many of the samples are those of ramps.
  const auto [cycle_s, speed_deg_s, decimals, half_deg] =
      GENERATE(std::tuple(0.012, 20.0, 2, 25.0), std::tuple(0.004, 10.0, 3, 25.0),
               std::tuple(0.004, 10.0, 4, 25.0), std::tuple(0.012, 40.0, 3, 25.0));
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(decimals, seed);
    const auto robot = some_robot(true, seed);
    simulation::Program program(robot.arm.home_rad);
    program.rest(1);
    for (std::size_t j = 0; j < robot.arm.joints(); ++j)
      program.sweep(j, half_deg, speed_deg_s, 0.5);
    const auto found =
        identify::identify(told(robot, program, cycle_s, decimals), campaign_of(robot, decimals));
    CHECK_FALSE((found.delay && is_significant(*found.delay)));
    CHECK_FALSE(accuses_gears(found));
    CHECK(found.status == Status::complete);
  }
}

TEST_CASE("angles of one clock with their positions make no delay that grows", "[delay][issue12]") {
  // One way, from whole degrees to whole degrees: all strokes are rounded as the others are.
  constexpr int kDecimals = 3;
  const auto robot = simulation::built(simulation::iiwa(), 4023);
  for (const double offset_s : {0.0, 0.3, 0.5, 1.0}) {
    CAPTURE(offset_s);
    simulation::Program program(robot.arm.home_rad);
    program.rest(1 + offset_s);
    for (std::size_t j = 0; j < robot.arm.joints(); ++j) program.sweep(j, 15, 10, 0.3);
    const auto found =
        identify::identify(told(robot, program, 0.004, kDecimals), campaign_of(robot, kDecimals));
    CHECK((!found.delay || found.delay->rate == 0));
    CHECK_FALSE(accuses_gears(found));
  }
}

TEST_CASE("what a delay that does not show for certain may be is in the table's uncertainty",
          "[delay][issue12][long]") {
  // One decimal, one way: only how joints get to speed tells of it, to some milliseconds.
  const double late_s = GENERATE(0.0, 0.008);
  CAPTURE(late_s);
  simulation::robots::Spread errors;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    const auto robot = some_robot(seed % 2 == 0, seed);
    const auto found = found_of_late(robot, late_s, 25, 0.5, 0.004);
    REQUIRE(found.delay);
    CHECK(std::abs(found.delay->late_s - late_s) < 3 * found.delay->sigma_s);
    CHECK(found.delay->sigma_s < 0.01);
    CHECK(found.status == Status::complete);
    const Simulation arm(robot, Strokes{}, World{}, seed);
    for (const double error : errors_in_sigmas(arm, found)) errors.add(error);
  }
  // Delays are rare, and one counts as such: where there is one, it has not all of its share.
  CHECK(errors.sigma() < (late_s > 0 ? 1.6 : 1.2));
  CHECK(errors.most < (late_s > 0 ? 6.5 : 4));
}

TEST_CASE("how joints get to speed is seen by positions where angles have few decimals",
          "[delay]") {
  // Of slow long sweeps it is a fiftieth, and angles tell a speed no sooner.
  constexpr double kLate_s = 0.03;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    const auto found = found_of_late(some_robot(seed % 2 == 0, seed), kLate_s, 45, 0.3, 0.012);
    REQUIRE(found.delay);
    CHECK(std::abs(found.delay->late_s - kLate_s) < 3 * found.delay->sigma_s);
    CHECK(found.delay->sigma_s < 0.01);
  }
}

TEST_CASE("a delay that does not show counts by how likely it is", "[delay]") {
  CHECK(untold_delay_s({0.1, 1e-4}) == 1e-4);  // one that was taken out
  // Against what it is known to, one of no size is small; one that nearly shows is as large.
  CHECK(untold_delay_s({0, 0.004}) < 0.2 * 0.004);
  CHECK(untold_delay_s({0, 1e-6}) < 0.01 * 1e-6);
  CHECK(untold_delay_s({0.0155, 0.004}) > 0.7 * 0.0155);
  CHECK(untold_delay_s({0.008, 0.004}) < untold_delay_s({0.012, 0.004}));
}

TEST_CASE("where nothing was told between two samples, no delay is told by how fast the joint was",
          "[delay][long]") {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    const Simulation simulation(some_robot(false, seed), both_ways(0), tracker_with_angles(0),
                                seed);
    auto sweeps = simulation.sweeps();
    for (std::size_t s = 1; s < sweeps.size(); ++s) {
      // A rest before the way back, of which only the first sample is there.
      if (sweeps[s].joint != sweeps[s - 1].joint || sweeps[s].direction > 0) continue;
      auto samples = *sweeps[s].samples;
      Sample rest = sweeps[s - 1].last();
      rest.time_s = samples.front().time_s - 2;
      samples.insert(samples.begin(), rest);
      sweeps[s].samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
    }
    const auto found = identify::identify(std::move(sweeps), simulation.campaign());
    REQUIRE(found.delay);
    CHECK_FALSE(is_significant(*found.delay));
    CHECK(found.delay->sigma_s > 5e-5);  // 60 arcsec of backlash are 0.4 ms each
    CHECK_FALSE(accuses_gears(found));
  }
}

TEST_CASE("a backlash is told from a delay by what all joints share", "[delay]") {
  auto world = tracker_with_angles(0.004);
  world.gears.backlash_arcsec = 120;
  const Simulation simulation(some_robot(false, 4), both_ways(0.1), world, 4);
  const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
  REQUIRE(found.delay);
  CHECK(std::abs(found.delay->late_s - 0.004) < 3 * found.delay->sigma_s);
}

TEST_CASE("strokes whose locked joints stood elsewhere tell less of a delay", "[delay][long]") {
  // Each stroke sees its joint turned by what the joints before it were off.
  const auto seen = GENERATE(true, false);
  CAPTURE(seen);
  double squares = 0;
  constexpr std::uint32_t kRuns = 8;
  for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
    CAPTURE(seed);
    auto world = tracker_with_angles(0);
    world.home.sigma_deg = 0.008;
    world.home.seen = seen;
    auto strokes = both_ways(0.1);
    strokes.repeats = 3;
    const Simulation simulation(some_robot(false, seed), strokes, world, seed);
    const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
    REQUIRE(found.delay);
    squares += std::pow(found.delay->late_s / found.delay->sigma_s, 2);
    CHECK_FALSE(is_significant(*found.delay));
    for (const Warning& warning : found.warnings)
      UNSCOPED_INFO(warning.code << ": " << warning.message);
    CHECK_FALSE(accuses_gears(found));
  }
  CHECK(std::sqrt(squares / kRuns) < 1.8);
}
