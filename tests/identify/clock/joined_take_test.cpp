#include "identify/clock/joined_take.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/device.hpp"
#include "tests/simulation/free_device.hpp"
#include "tests/simulation/truth.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;
using namespace simulation;
using identify::kDegree;

namespace {

identify::Campaign known(const Robot& robot) {
  identify::Campaign campaign;
  campaign.joints = robot.arm.joints();
  campaign.specified = robot.specified;
  campaign.resolution.angle_rad = 1e-4 * kDegree;
  campaign.device_frame = campaign.two_clocks = true;
  return campaign;
}

/// Sweeps of all joints, there and back, with rests that are no two alike.
Program sweeps_of_all(const Robot& robot, int rounds, std::uint32_t seed, double rest_s = 0.35) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> more(0, 0.4);
  Program program(robot.arm.home_rad);
  program.rest(2);
  for (int round = 0; round < rounds; ++round)
    for (std::size_t j = 0; j < robot.arm.joints(); ++j)
      program.sweep(j, 40 + 5 * static_cast<double>(j % 3), 20, rest_s + more(random)).rest(0.3);
  return program.rest(2);
}

FreeDevice unkind(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> uniform(0, 1);
  FreeDevice device;
  device.ahead_s = 0.5 * uniform(random);
  device.rate_ppm = 100 * (uniform(random) - 0.5);
  device.jitter_s = 0.005;
  device.loss = 0.02;
  device.gaps = {{20, 20.4}, {41, 43}};
  return device;
}

/// Of predicted positions over poses all round home, root mean square.
double geometry_error_mm(const identify::Identification& found, const Robot& robot,
                         std::uint32_t seed) {
  REQUIRE(found.chain);
  const auto chain = chain_of(robot);
  const auto base = random_place(seed);
  std::mt19937 random(5);
  std::uniform_real_distribution<> range(-60 * kDegree, 60 * kDegree);
  double squares = 0;
  constexpr int kPoses = 100;
  for (int i = 0; i < kPoses; ++i) {
    identify::Turns turns{}, from_found{};
    for (std::size_t j = 0; j < robot.arm.joints(); ++j) {
      turns[j] = range(random);
      from_found[j] = turns[j] + robot.arm.home_rad[j] - *found.home_rad[j];
    }
    squares += (found.chain->chain.target_mm(0, from_found) - base * chain.target_mm(0, turns))
                   .squaredNorm();
  }
  return std::sqrt(squares / kPoses);
}

struct Joined {
  identify::JoinedTake take;
  identify::Identification found;
  identify::ClockMatch clock;
};

Joined join(const Robot& robot, const TwoViews& views) {
  Joined all;
  auto campaign = known(robot);
  all.take = identify::joined(views.tape, views.points, campaign);
  INFO(all.take.problem);
  REQUIRE(all.take.problem.empty());
  campaign.resolution.time_s = all.take.stamp_step_s;
  all.found = identify::identify(all.take.sweeps, campaign, all.take.poses);
  all.clock = identify::refined(all.take.clock, all.found.delay);
  return all;
}

std::string problem_of(const Robot& robot, const TwoViews& views) {
  return identify::joined(views.tape, views.points, known(robot)).problem;
}

}  // namespace

TEST_CASE(
    "Offset and drift of an unkind device are found within their uncertainty, and cost the "
    "geometry nothing",
    "[joined_take][long]") {
  int within = 0;
  double squares = 0, plain = 0, offs = 0, stated = 0;
  constexpr std::uint32_t kSeeds = 6;
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Robot robot = built(kr5(), seed);
    const Program program = sweeps_of_all(robot, 2, seed);
    const FreeDevice device = unkind(seed);
    const auto joined = join(robot, two_views(robot, program, device, seed));
    const double middle_s = program.seconds() / 2;
    const double off_s =
        joined.clock.ahead_s + joined.clock.rate * (middle_s - joined.clock.at_s) - device.ahead_s;
    INFO("seed " << seed << ": off by " << 1e3 * off_s << " ms, sigma "
                 << 1e3 * joined.clock.sigma_s);
    CHECK(std::abs(off_s) < 4 * joined.clock.sigma_s);
    offs += off_s * off_s;
    stated += joined.clock.sigma_s * joined.clock.sigma_s;
    if (std::abs(off_s) < 2 * joined.clock.sigma_s) ++within;
    CHECK_THAT(joined.clock.rate, WithinAbs(1e-6 * device.rate_ppm, 4 * joined.clock.rate_sigma));
    CHECK(joined.take.poses.size() > 30);
    squares += std::pow(geometry_error_mm(joined.found, robot, seed), 2);
    FreeDevice same = device;
    same.ahead_s = same.rate_ppm = 0;
    plain += std::pow(
        geometry_error_mm(join(robot, two_views(robot, program, same, seed)).found, robot, seed),
        2);
  }
  CHECK(within >= 5);
  CHECK(std::sqrt(offs / kSeeds) < 1e-4);
  CHECK(stated < 2 * offs);
  CHECK(std::sqrt(squares / plain) < 1.05);
}

TEST_CASE("Rests are poses, and motion of several joints is left out", "[joined_take]") {
  const Robot robot = built(kr5(), 4);
  Program program(robot.arm.home_rad);
  std::mt19937 random(1);
  std::uniform_real_distribution<> off(-50, 50), rest(0.5, 1.5);
  program.rest(1);
  for (int i = 0; i < 60; ++i) {
    std::vector<Program::To> to;
    for (std::size_t j = 0; j < 6; ++j)
      to.push_back({j, robot.arm.home_rad[j] / kDegree + off(random)});
    program.move(to, 60).rest(rest(random));
  }
  FreeDevice device = unkind(4);
  device.ahead_s = 4711;
  const auto joined = join(robot, two_views(robot, program, device, 4));
  CHECK(joined.take.sweeps.empty());
  CHECK(joined.take.poses.size() >= 57);
  CHECK(joined.take.left_out_s > 60);
  CHECK_THAT(joined.clock.ahead_s, WithinAbs(4711, 0.02));
  CHECK(joined.clock.sigma_s < 0.01);
  CHECK(geometry_error_mm(joined.found, robot, 4) < 0.05);
}

TEST_CASE("What does not belong together is refused, and why is told", "[joined_take]") {
  const Robot robot = built(kr5(), 5);
  const Program program = sweeps_of_all(robot, 2, 5);
  const auto views = two_views(robot, program, unkind(5), 5);

  SECTION("a trace of another day") {
    const Program other = sweeps_of_all(robot, 2, 77, 0.9);
    CHECK_THAT(problem_of(robot, {two_views(robot, other, {}, 6).tape, views.points}),
               ContainsSubstring("do not agree"));
  }
  SECTION("a clock that is set midway") {
    FreeDevice device = unkind(5);
    device.step_s = 0.5;
    device.step_at_s = program.seconds() / 2;
    CHECK_THAT(problem_of(robot, two_views(robot, program, device, 5)),
               ContainsSubstring("offset of the clocks changes"));
  }
  SECTION("a device whose program began anew") {
    auto points = views.points;
    const double begin_s = points.front().sample.time_s;
    for (std::size_t i = points.size() * 9 / 10; i < points.size(); ++i)
      points[i].sample.time_s -= points[points.size() * 9 / 10 - 1].sample.time_s - begin_s;
    CHECK_THAT(problem_of(robot, {views.tape, points}),
               ContainsSubstring("the device's times go back from"));
  }
  SECTION("positions in metres") {
    auto points = views.points;
    for (auto& point : points) point.sample.position_mm /= 1000;
    CHECK_THAT(problem_of(robot, {views.tape, points}),
               ContainsSubstring("name the columns x_m, y_m, z_m, if these are metres"));
  }
  SECTION("times in milliseconds") {
    auto points = views.points;
    for (auto& point : points) point.sample.time_s *= 1000;
    CHECK_THAT(problem_of(robot, {views.tape, points}),
               ContainsSubstring("give seconds in t_s, if these are milliseconds"));
  }
  SECTION("a device that saw nothing move") {
    auto points = views.points;
    for (auto& point : points) point.sample.position_mm = {1000, 0, 0};
    CHECK_THAT(problem_of(robot, {views.tape, points}), ContainsSubstring("show 0 motions"));
  }
  SECTION("nothing at all") {
    CHECK_FALSE(problem_of(robot, {identify::AngleTape(6), {}}).empty());
  }
}

TEST_CASE("A take that was cut is joined as far as it goes", "[joined_take]") {
  const Robot robot = built(kr5(), 6);
  auto views = two_views(robot, sweeps_of_all(robot, 2, 6), unkind(6), 6);
  views.points.resize(views.points.size() * 6 / 10);
  const auto joined = join(robot, views);
  CHECK(joined.clock.matched > 15);
  CHECK(geometry_error_mm(joined.found, robot, 6) < 0.05);
}

TEST_CASE("Sweeps that are all alike are told apart by the specified arm, or refused",
          "[joined_take]") {
  const Robot robot = built(kr5(), 7);
  Program program(robot.arm.home_rad);
  program.rest(0.6);
  for (std::size_t j = 0; j < 6; ++j) program.sweep(j, 40, 20, 0.5);
  FreeDevice device = unkind(7);
  device.gaps.clear();
  device.ahead_s = 33.25;
  const auto views = two_views(robot, program, device, 7);
  CHECK_THAT(join(robot, views).clock.ahead_s, WithinAbs(33.25, 0.001));

  auto campaign = known(robot);
  campaign.specified.reset();
  const auto unknown = identify::joined(views.tape, views.points, campaign);
  CHECK_THAT(unknown.problem, ContainsSubstring("--robot"));
}

TEST_CASE("The same tape and points give the same take", "[joined_take][long]") {
  const Robot robot = built(kr5(), 8);
  const auto views = two_views(robot, sweeps_of_all(robot, 1, 8), unkind(8), 8);
  const auto once = join(robot, views), again = join(robot, views);
  CHECK(once.clock.ahead_s == again.clock.ahead_s);
  CHECK(once.found.dh.front().b_mm.value == again.found.dh.front().b_mm.value);
}

TEST_CASE("Several targets have each a place of their own about an axis", "[joined_take][long]") {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Robot robot = built(kr5(3), seed);
    FreeDevice device;
    device.ahead_s = 1.25;
    const auto joined = join(robot, two_views(robot, sweeps_of_all(robot, 1, seed), device, seed));
    const double off_s = joined.clock.ahead_s - device.ahead_s;
    INFO("seed " << seed << ": off by " << 1e6 * off_s << " us, sigma "
                 << 1e6 * joined.clock.sigma_s);
    CHECK(std::abs(off_s) < 4 * joined.clock.sigma_s);
    CHECK(joined.clock.sigma_s < 1e-4);
    CHECK(std::none_of(joined.found.warnings.begin(), joined.found.warnings.end(),
                       [](const auto& warning) { return warning.code == "backlash"; }));
  }
}

TEST_CASE("Noise that hides the ends of motions does not part the clocks", "[joined_take][long]") {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Robot robot = built(kr5(), seed);
    FreeDevice device;
    device.noise.range_mm = device.noise.across_mm = 0.3;
    device.ahead_s = 0.5;
    const auto joined = join(robot, two_views(robot, sweeps_of_all(robot, 1, seed), device, seed));
    CHECK(std::abs(joined.clock.ahead_s - device.ahead_s) < 4 * joined.clock.sigma_s);
    CHECK(joined.clock.sigma_s < 5e-4);
  }
}

TEST_CASE("A take that ends before all joints have moved is told to lack axes",
          "[joined_take][long]") {
  const Robot robot = built(kr5(), 9);
  const auto views = two_views(robot, sweeps_of_all(robot, 1, 9), unkind(9), 9);
  for (const double share : {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
    auto cut = views;
    cut.points.resize(static_cast<std::size_t>(share * static_cast<double>(views.points.size())));
    const auto campaign = known(robot);
    const auto take = identify::joined(cut.tape, cut.points, campaign);
    INFO(share << " " << take.problem);
    if (!take.problem.empty()) continue;  // too little to match the clocks by
    const auto found = identify::identify(take.sweeps, campaign, take.poses);
    if (share < 0.8) CHECK(found.status != identify::Status::complete);
  }
}

TEST_CASE("Clocks that drift apart, and stamps that are rounded, are no backlash of gears",
          "[joined_take][long]") {
  for (const double stamp_step_s : {0.0, 0.001})
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      CAPTURE(stamp_step_s, seed);
      const Robot robot = built(kr5(), seed);
      const Program program = sweeps_of_all(robot, 1, seed, 0.7);
      FreeDevice device;
      device.ahead_s = 17.3 * seed;
      device.rate_ppm = seed % 2 == 0 ? 300 : 20;
      device.stamp_step_s = stamp_step_s;
      const auto joined = join(robot, two_views(robot, program, device, seed));
      for (const auto& warning : joined.found.warnings) CHECK(warning.code != "backlash");
      const double middle_s = program.seconds() / 2;
      const double late_s = joined.clock.ahead_s +
                            joined.clock.rate * (middle_s - joined.clock.at_s) - device.ahead_s;
      CHECK(joined.clock.sigma_s < 2e-4);
      CHECK(std::abs(late_s) < 4 * joined.clock.sigma_s);
      CHECK(std::abs(joined.clock.rate - 1e-6 * device.rate_ppm) < 4 * joined.clock.rate_sigma);
    }
}

TEST_CASE("A device that drifts evenly while rests are measured, too, moved no target",
          "[joined_take][long]") {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const Robot robot = built(kr5(), seed);
    FreeDevice device;
    device.drift.linear_mm = 0.1;
    const auto found =
        join(robot, two_views(robot, sweeps_of_all(robot, 1, seed, 0.7), device, seed)).found;
    CHECK(found.status == identify::Status::complete);
    CHECK(found.chain->steady_drift);
    for (const auto& warning : found.warnings) CHECK(warning.code != "poses_drift");
  }
}

TEST_CASE("On which side of its play a joint stood before its first move is open in the table",
          "[joined_take][long]") {
  World world;
  world.placed = true;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const Robot robot = built(kr5(), seed);
    FreeDevice device = unkind(seed);
    device.play_arcsec = 30;
    const auto found =
        join(robot, two_views(robot, sweeps_of_all(robot, 2, seed), device, seed)).found;
    REQUIRE(found.estimator == identify::Estimator::poses);
    // Home is in the middle of the play.
    for (const double error : errors_in_sigmas(Simulation(robot, {}, world, seed), found))
      CHECK(std::abs(error) < 3.5);
  }
}
