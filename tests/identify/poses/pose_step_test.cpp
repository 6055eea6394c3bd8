#include "identify/poses/pose_step.hpp"

#include <algorithm>
#include <cmath>

#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/judged_poses.hpp"

using namespace identify;
using namespace simulation::robots;

TEST_CASE("A device or a base that is moved anywhere amid the poses is noticed, and where",
          "[pose_step][long]") {
  const std::size_t from = GENERATE(10U, 25U, 40U);
  const double moved_mm = GENERATE(0.1, 0.3, 1.0);
  CAPTURE(from, moved_mm);
  Judged all;
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const auto built = arm_with(tracker(), seed);
    auto poses = built.poses(50);
    const Eigen::Vector3d by = moved_mm / std::sqrt(3) * Eigen::Vector3d(1, -1, 1);
    for (std::size_t i = from; i < poses.size(); ++i) poses[i].sample.position_mm += by;
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    CHECK(found.status == Status::doubtful);
    REQUIRE_FALSE(found.doubts.empty());
    CHECK(found.doubts.front().code == "device_moved");
    // 0.1 mm are five times the noise.
    const auto place = static_cast<double>(found.poses->step.from);
    CHECK(place == Approx(static_cast<double>(from)).margin(moved_mm < 0.2 ? 2 : 1));
    CHECK_THAT(found.doubts.front().message,
               Catch::Matchers::ContainsSubstring(poses[found.poses->step.from].name));
    CHECK(found.poses->step.moved_mm == Approx(moved_mm).margin(0.05));
    judge(built, found, all);
  }
  CHECK(all.farthest < 5);
}

TEST_CASE("What was moved is told: a target on the tool is no device", "[pose_step][long]") {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const auto built = arm_with(tracker(), seed);
    auto poses = built.poses(50);
    auto robot = built.robot();
    robot.targets_mm[0] += Eigen::Vector3d(0.1, -0.2, 0.2);
    const auto after = simulation::Simulation(robot, strokes(50), tracker(), seed).poses(50);
    std::copy(after.begin() + 40, after.end(), poses.begin() + 40);
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    CHECK(found.status == Status::doubtful);
    REQUIRE_FALSE(found.doubts.empty());
    CHECK(found.doubts.front().code == "target_moved");
  }
}

TEST_CASE("A joint that slips amid the poses is named, and by how much", "[pose_step][long]") {
  const std::size_t joint = GENERATE(0U, 1U, 2U, 4U);
  CAPTURE(joint);
  Judged all;
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const auto built = arm_with(tracker(), seed);
    auto poses = built.poses(50);
    for (std::size_t i = 40; i < poses.size(); ++i)
      poses[i].sample.angles_rad[joint] -= 0.02 * kDegree;
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    CHECK(found.status == Status::doubtful);
    REQUIRE_FALSE(found.doubts.empty());
    CHECK(found.doubts.front().code == "joint_slipped");
    CHECK(found.doubts.front().joint == joint);
    CHECK(found.poses->step.from == 40);
    CHECK(found.poses->step.turned == Approx(0.02 * kDegree).epsilon(0.2));
    judge(built, found, all);
  }
  CHECK(all.farthest < 5);
}

TEST_CASE("An arm that warms up is not said to have been moved", "[pose_step][long]") {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const auto built = arm_with(tracker(0.001), seed);
    auto poses = built.poses(120);
    for (std::size_t i = 0; i < poses.size(); ++i)
      poses[i].sample.angles_rad[1] +=
          0.02 * kDegree * static_cast<double>(i) / static_cast<double>(poses.size());
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    CHECK(found.status == Status::complete);
    CHECK(std::any_of(found.warnings.begin(), found.warnings.end(),
                      [](const Warning& one) { return one.code == "poses_drift"; }));
  }
}

TEST_CASE("A device that warms up, or sways once, is not said to have been moved",
          "[pose_step][long]") {
  const bool sways = GENERATE(false, true);
  const auto drifting = [&](std::uint32_t seed) {
    auto world = tracker();
    (sways ? world.drift.sway_mm : world.drift.warm_mm) = 0.1;
    return arm_with(world, seed);
  };
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto built = drifting(seed);
    const auto found = identify::identify({}, built.campaign(), built.poses(20 + 10 * seed));
    CAPTURE(sways, seed, found.reason);
    CHECK(found.status == Status::complete);
  }
  // Sweeps before them tell the frame, too.
  const auto built = drifting(4);
  const auto found = identify::identify(built.sweeps(), built.campaign(), built.poses(60));
  CAPTURE(sways, found.reason);
  CHECK(found.status == Status::complete);
}

TEST_CASE("Of poses amid which nothing was moved no step is seen", "[pose_step][long]") {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const auto built = arm_with(tracker(seed % 3 * 0.002), seed, 1 + seed % 2);
    const auto found = estimated(built.poses(30 + seed), built.campaign());
    REQUIRE(found);
    INFO("seed " << seed << ", chi-square " << found->step.chi_squared);
    CHECK_FALSE(found->step.seen);
  }
}
