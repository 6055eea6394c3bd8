#include "identify/poses/pose_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <utility>

#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/judged_poses.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

bool warned(const Identification& found, const std::string& code) {
  return std::any_of(found.warnings.begin(), found.warnings.end(),
                     [&](const Warning& one) { return one.code == code; });
}

std::string first_doubt(const simulation::Simulation& built, std::vector<Pose> poses,
                        const std::function<void(Pose&)>& spoil) {
  for (Pose& pose : poses) spoil(pose);
  const auto found = identify::identify({}, built.campaign(), poses);
  CHECK((found.status == Status::doubtful || found.status == Status::failed));
  if (found.doubts.empty()) return "";
  CHECK_THAT(found.reason, Catch::Matchers::StartsWith(found.doubts.front().message));
  // Nobody has to measure again what was only told wrongly.
  CHECK_FALSE(warned(found, "joint_not_turned"));
  // Where no arm fits, nobody knows where axes are, or what circles would tell.
  if (found.status == Status::failed) CHECK(found.doubts.size() == 1);
  return found.doubts.front().code;
}

}  // namespace

TEST_CASE("What is wrong with all poses is named", "[pose_doubts][long]") {
  const auto built = arm_with(tracker(), 2);
  const auto poses = built.poses(40);
  const auto doubt = [&](const std::function<void(Pose&)>& spoil) {
    return first_doubt(built, poses, spoil);
  };
  CHECK(doubt([](Pose& pose) { pose.sample.position_mm /= 1000; }) == "unit_factor");
  CHECK(doubt([](Pose& pose) {
          for (double& angle : pose.sample.angles_rad) angle *= kDegree;
        }) == "unit_factor");
  CHECK(doubt([](Pose& pose) {
          std::swap(pose.sample.position_mm.x(), pose.sample.position_mm.y());
        }) == "frame_mirrored");
  CHECK(doubt([](Pose& pose) { pose.sample.angles_rad[2] *= -1; }) == "angles_negated");
  CHECK(doubt([](Pose& pose) {
          std::swap(pose.sample.angles_rad[3], pose.sample.angles_rad[4]);
        }) == "joints_exchanged");
}

TEST_CASE("One pose that is metres off is left out, whichever it is", "[pose_doubts][long]") {
  const auto built = arm_with(tracker(0.002), 5);
  for (const double off_mm : {2000.0, 50'000.0})
    for (std::size_t wrong = 0; wrong < 60; wrong += 6) {
      auto poses = built.poses(60);
      poses[wrong].sample.position_mm.z() -= off_mm;
      const auto found = identify::identify({}, built.campaign(), poses);
      INFO(off_mm << " mm, pose " << wrong << ": " << found.reason);
      CHECK(found.status == Status::complete);
      CHECK(warned(found, "pose_outliers"));
    }
}

TEST_CASE("Angles of other poses are not the arm's", "[pose_doubts][long]") {
  const auto built = arm_with(tracker(), 3);
  auto poses = built.poses(40);
  for (std::size_t i = 0; i + 1 < poses.size(); ++i)
    poses[i].sample.angles_rad = poses[i + 1].sample.angles_rad;
  CHECK(first_doubt(built, poses, [](Pose&) {}) == "pose_misfit");
}

TEST_CASE("A target that was put back elsewhere is noticed, and where", "[pose_doubts]") {
  const auto built = arm_with(tracker(0.002), 4);
  auto poses = built.poses(60);
  auto robot = built.robot();
  robot.targets_mm[0] += Eigen::Vector3d(0.5, -0.3, 0.4);
  const auto after = simulation::Simulation(robot, strokes(50), tracker(0.002), 4).poses(60);
  std::copy(after.begin() + 25, after.end(), poses.begin() + 25);
  const auto found = identify::identify({}, built.campaign(), poses);
  CHECK(found.status == Status::doubtful);
  REQUIRE_FALSE(found.doubts.empty());
  CHECK(found.doubts.front().code == "target_moved");
  CHECK_THAT(found.doubts.front().message, Catch::Matchers::ContainsSubstring("pose 2"));
}

TEST_CASE("A target that is off by as little as a device drifts is no doubt, and is told",
          "[pose_doubts]") {
  auto world = tracker();
  world.noise.range_mm = world.noise.across_mm = 0.004;
  const auto built = arm_with(world, 4);
  auto poses = built.poses(60);
  auto robot = built.robot();
  robot.targets_mm[0] += Eigen::Vector3d(0.02, -0.02, 0.02);
  const auto after = simulation::Simulation(robot, strokes(50), world, 4).poses(60);
  std::copy(after.begin() + 25, after.end(), poses.begin() + 25);
  const auto found = identify::identify({}, built.campaign(), poses);
  CHECK(found.doubts.empty());
  CHECK(std::any_of(found.warnings.begin(), found.warnings.end(), [](const auto& warning) {
    return warning.code == "target_moved" || warning.code == "poses_drift";
  }));
}

TEST_CASE("A device that was moved between sweeps and poses is noticed", "[pose_doubts][long]") {
  const double moved_mm = GENERATE(0.0, 0.6, 50.0);
  CAPTURE(moved_mm);
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const auto built = arm_with(tracker(), seed);
    auto poses = built.poses(30);
    for (Pose& pose : poses)
      pose.sample.position_mm += moved_mm / std::sqrt(3) * Eigen::Vector3d(1, -1, 1);
    const auto found = identify::identify(built.sweeps(), built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    CHECK((found.status == Status::complete) == (moved_mm == 0));
    if (moved_mm > 0) CHECK(found.doubts.front().code == "device_moved");
  }
}

TEST_CASE("A device that was moved amid the poses is noticed", "[pose_doubts]") {
  const auto built = arm_with(tracker(), 4);
  auto poses = built.poses(60);
  for (std::size_t i = 30; i < poses.size(); ++i)
    poses[i].sample.position_mm += Eigen::Vector3d(1, -1, 1);
  const auto found = identify::identify({}, built.campaign(), poses);
  CHECK(found.status == Status::doubtful);
  REQUIRE_FALSE(found.doubts.empty());
  CHECK(
      (found.doubts.front().code == "device_moved" || found.doubts.front().code == "target_moved"));
}

TEST_CASE("Targets that have no names of their own are noticed", "[pose_doubts][long]") {
  const auto built = arm_with(tracker(), 4, 3);
  auto poses = built.poses(60);
  for (Pose& pose : poses) pose.target = 0;
  const auto found = identify::identify({}, built.campaign(), poses);
  CHECK(found.status != Status::complete);
  CHECK_THAT(found.reason, Catch::Matchers::ContainsSubstring("several targets"));
}

TEST_CASE("One wrong pose in twenty is left out and named; the others tell the same",
          "[pose_doubts]") {
  const auto built = arm_with(tracker(), 5);
  auto poses = built.poses(60);
  const auto clean = identify::identify({}, built.campaign(), poses);
  for (const std::size_t i : std::vector<std::size_t>{3, 24, 50})
    poses[i].sample.position_mm += Eigen::Vector3d(2, -3, 1);
  const auto found = identify::identify({}, built.campaign(), poses);
  INFO(found.reason);
  CHECK(found.status == Status::complete);
  CHECK(found.poses->outliers == std::vector<std::size_t>{3, 24, 50});
  CHECK(warned(found, "pose_outliers"));
  for (std::size_t i = 0; i < found.dh.size(); ++i)
    CHECK(found.dh[i].a_mm.value ==
          Approx(clean.dh[i].a_mm.value).margin(1e-9 + 2 * clean.dh[i].a_mm.sigma));
}

TEST_CASE("A third of the poses that lie far off misleads neither the fit nor what is said of it",
          "[pose_doubts][long]") {
  const std::size_t count = GENERATE(30U, 50U, 100U);
  CAPTURE(count);
  Judged all;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto built = arm_with(tracker(), seed);
    auto poses = built.poses(count);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random);
    for (std::size_t k = 0; k < 3 * count / 10; ++k)
      poses[order[k]].sample.position_mm +=
          20 * Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    CHECK(found.status == Status::doubtful);
    CHECK(found.doubts.front().code == "pose_outliers");
    CHECK(found.poses->outliers.size() == 3 * count / 10);
    judge(built, found, all);
  }
  CHECK(all.farthest < 5);
}

TEST_CASE("Axes that poses hardly tell are named", "[pose_doubts]") {
  const auto built = arm_with(tracker(), 5);
  std::vector<std::vector<double>> angles_rad;
  for (const Pose& pose : built.poses(40)) {
    angles_rad.push_back(angles_of(pose.sample));
    double& last = angles_rad.back().back();  // within 12 deg of home
    last = built.robot().arm.home_rad.back() + (last - built.robot().arm.home_rad.back()) * 12 / 80;
  }
  const auto found = identify::identify({}, built.campaign(), built.poses_at(angles_rad));
  INFO(found.reason);
  REQUIRE(found.joints[5].axis);
  CHECK(std::count_if(found.warnings.begin(), found.warnings.end(), [](const Warning& one) {
          return one.code == "joint_hardly_turned" && one.joint == 5;
        }) == 1);
  CHECK_FALSE(
      warned(identify::identify({}, built.campaign(), built.poses(40)), "joint_hardly_turned"));
}

TEST_CASE("Copies of poses count once", "[pose_doubts]") {
  const auto built = arm_with(tracker(), 6);
  auto poses = built.poses(40);
  const auto once = identify::identify({}, built.campaign(), poses);
  for (std::size_t i = 0; i < 40; ++i) poses.push_back(poses[i]);
  const auto found = identify::identify({}, built.campaign(), poses);
  CHECK(warned(found, "pose_copies"));
  CHECK(found.dh[1].a_mm.sigma == once.dh[1].a_mm.sigma);
}

TEST_CASE("An orientation that stands beside each of two targets counts once",
          "[pose_doubts][long]") {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const auto built = arm_with(tracker(), seed, 2);
    const auto arm = robot(seed, 2).arm;
    std::mt19937 random(seed);
    std::uniform_real_distribution<> turn(-50 * kDegree, 50 * kDegree);
    std::normal_distribution<> noise(0, 1e-5);
    std::vector<std::vector<double>> stands;
    for (int i = 0; i < 30; ++i) {
      auto angles = arm.home_rad;
      for (double& angle : angles) angle += turn(random);
      stands.insert(stands.end(), 2, angles);
    }
    auto poses = built.poses_at(stands);
    for (std::size_t i = 0; i < poses.size(); i += 2) {
      const Eigen::Isometry3d frame =
          built.base() * forward_kinematics(arm, {stands[i].begin(), stands[i].end()});
      const Eigen::Vector3d off(noise(random), noise(random), noise(random));
      const Eigen::AngleAxisd error(off.norm(), off.normalized());
      for (const std::size_t k : {i, i + 1}) {
        poses[k].sample.has_orientation = true;
        poses[k].sample.abc_rad = abc_of(error.toRotationMatrix() * frame.linear());
      }
    }
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    CHECK(found.status == Status::complete);
    // Joints may take up some of it; copies as if independent left none.
    CHECK(found.poses->fit.noise.orientation_rad > 3e-6);
    CHECK(found.poses->fit.noise.orientation_rad < 3e-5);
  }
}

TEST_CASE("Clean poses of many kinds are not doubted", "[pose_doubts][long]") {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto built = arm_with(tracker(seed % 3 * 0.002), seed, 1 + seed % 2);
    const auto found = identify::identify({}, built.campaign(), built.poses(50));
    INFO("seed " << seed << ": " << found.reason);
    CHECK(found.status == Status::complete);
    CHECK(found.doubts.empty());
  }
}
