#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "identify/identification.hpp"
#include "identify/poses/pose_start.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/judged_poses.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;
using namespace simulation::robots;

TEST_CASE(
    "Uncertainties hold of arms that give way to weights that nobody knows, also where they swept",
    "[pose_estimate][pose_effects][pose_sag][long]") {
  const bool swept = GENERATE(false, true);
  Judged all;
  auto world = tracker();
  world.sag_arcsec = 60;
  for (std::uint32_t seed = 1; seed <= (swept ? 10U : 25U); ++seed) {
    const auto built = arm_with(world, seed);
    const auto sweeps = swept ? built.sweeps() : std::vector<Sweep>();
    INFO("seed " << seed);
    judge_complete(built, sweeps, 40, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(all.farthest < 5);
}

TEST_CASE("Uncertainties hold of sweeps beside so few poses that these do not show what gives way",
          "[pose_estimate][pose_sag][long]") {
  Judged all;
  auto world = tracker();
  world.sag_arcsec = 60;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto robot =
        simulation::at_random_home(simulation::built(simulation::iiwa(), seed), seed);
    const simulation::Simulation built(robot, simulation::Strokes(), world, seed);
    INFO("seed " << seed);
    judge_complete(built, built.sweeps(), 8, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.9);
  CHECK(all.farthest < 6);
}

TEST_CASE("Many poses show that nothing gives way, few do not", "[pose_estimate][pose_sag][long]") {
  const auto built = arm_with(tracker(), 3);
  const auto unsure_rad = [&](std::size_t count) {
    const auto found = identify::identify(built.sweeps(), built.campaign(), built.poses(count));
    REQUIRE(found.poses);
    return found.poses->weights_unsure_rad;
  };
  CHECK(unsure_rad(6) > 4 * kArcsec);
  CHECK(unsure_rad(6) <= 10 * kArcsec);
  CHECK(unsure_rad(100) < unsure_rad(6) / 2);
}

TEST_CASE("Sweeps of some joints, and poses of all, tell the table",
          "[pose_estimate][pose_start][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const auto built = arm_with(tracker(), seed);
    INFO("seed " << seed);
    judge_complete(built, sweeps_without(seed % 6, built), 20, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(all.farthest < 4.5);
}

TEST_CASE("A joint that never turned has no axis", "[pose_estimate][pose_start][long]") {
  const std::size_t joint = GENERATE(2U, 4U, 5U);
  const auto built = arm_with(tracker(), 1);
  std::vector<std::vector<double>> angles_rad;
  for (const Pose& pose : built.poses(15)) {
    angles_rad.emplace_back(pose.sample.angles_rad.begin(), pose.sample.angles_rad.begin() + 6);
    angles_rad.back()[joint] = built.robot().arm.home_rad[joint];
  }
  const auto found = identify::identify(sweeps_without(joint, built), built.campaign(),
                                        built.poses_at(angles_rad));
  CHECK(found.status == Status::partial);
  CHECK(found.reason == "no axis for joint " + std::to_string(joint + 1));
  for (std::size_t j = 0; j < 6; ++j) CHECK(found.joints[j].axis.has_value() == (j != joint));
}

TEST_CASE("A device that drifted between sweeps and poses accuses no joint",
          "[pose_estimate][pose_start][long]") {
  Judged all;
  auto drifting = tracker();
  drifting.drift.linear_mm = 0.5;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto sweeps = arm_with(drifting, seed).sweeps();
    const auto built = arm_with(tracker(), seed);  // before it drifted
    const auto found = identify::identify(sweeps, built.campaign(), built.poses(30));
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    REQUIRE(found.poses);
    CHECK(found.poses->effects.empty());
    REQUIRE(found.chain);
    CHECK(found.chain->steady_drift);
    judge(built, found, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
}

TEST_CASE("Joints that come home badly between sweeps are no moved device, beside poses neither",
          "[pose_estimate][home_judgement][long]") {
  auto world = tracker(0.005);
  world.home.lasts = HomeLasts::rest;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const simulation::Simulation built(simulation::built(simulation::palletizer(), seed),
                                       strokes(50), world, seed);
    INFO("seed " << seed);
    const auto alone = identify::identify(built.sweeps(), built.campaign());
    REQUIRE(alone.status == Status::complete);
    const auto beside = identify::identify(built.sweeps(), built.campaign(), built.poses(20));
    INFO(beside.reason);
    CHECK(beside.status == Status::complete);
  }
}

TEST_CASE("Sweeps that the fit of poses does not use are named", "[pose_estimate][long]") {
  const auto built = arm_with(tracker());
  auto sweeps = built.sweeps();
  for (Sweep& sweep : sweeps) {  // no angles, and nothing tells home
    auto samples = *sweep.samples;
    for (Sample& sample : samples) sample.joints = 0;
    sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  }
  auto campaign = built.campaign();
  campaign.declared_home_rad.clear();
  const auto found = identify::identify(sweeps, campaign, built.poses(30));
  REQUIRE(found.poses);
  REQUIRE_FALSE(found.poses->with_sweeps);
  const auto* said = identify::test::find_warning(found, "sweeps_not_used");
  REQUIRE(said != nullptr);
  CHECK_THAT(said->message, Catch::Matchers::StartsWith("the numbers are by the poses alone"));
  const auto with_all = identify::identify(built.sweeps(), built.campaign(), built.poses(30));
  REQUIRE(with_all.poses->with_sweeps);
  CHECK(identify::test::find_warning(with_all, "sweeps_not_used") == nullptr);
}

TEST_CASE("Few poses of a device that was moved are told to scatter",
          "[pose_estimate][advice][long]") {
  const bool moved = GENERATE(false, true);
  CAPTURE(moved);
  int noisy = 0;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const auto built = arm_with(tracker(), seed);
    auto poses = built.poses(8);
    for (Pose& pose : poses)
      if (moved) pose.sample.position_mm.x() += 0.4;
    const auto found = identify::identify(built.sweeps(), built.campaign(), poses);
    const bool scatter =
        std::any_of(found.warnings.begin(), found.warnings.end(),
                    [](const Warning& warning) { return warning.code == "poses_noisy"; });
    CHECK((scatter || !found.doubts.empty()) == moved);
    if (scatter) ++noisy;
  }
  CHECK((noisy > 0) == moved);
}

TEST_CASE("Sweeps and poses together are no worse than either", "[pose_estimate][long]") {
  double sweeps = 0, poses = 0, both = 0;
  Judged all;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const auto built = arm_with(tracker(), seed);
    const auto static_ones = built.poses(30);
    sweeps += error_of(built, identify::identify(built.sweeps(), built.campaign()));
    poses += error_of(built, identify::identify({}, built.campaign(), static_ones));
    const auto together = identify::identify(built.sweeps(), built.campaign(), static_ones);
    REQUIRE(together.estimator == Estimator::poses);
    REQUIRE(together.poses->with_sweeps);
    both += error_of(built, together);
    judge(built, together, all);
  }
  CHECK(both < 1.05 * sweeps);
  CHECK(both < 1.05 * poses);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
}
