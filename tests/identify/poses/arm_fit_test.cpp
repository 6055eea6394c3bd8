#include "identify/poses/arm_fit.hpp"

#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"
#include "tests/simulation/level_oracle.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

Eigen::VectorXd ones(const std::vector<Pose>& poses) {
  return Eigen::VectorXd::Ones(static_cast<Eigen::Index>(poses.size()));
}

}  // namespace

TEST_CASE("An arm as specified is found wherever it stands", "[arm_fit]") {
  auto world = tracker();
  world.noise = {};
  const simulation::Simulation as_specified(simulation::kr5(2), strokes(10), world, 4);
  const auto poses = as_specified.poses(30);
  const auto found = placed_robustly(as_specified.robot().specified, Freedom::frames, poses, 2);
  CHECK(distances_mm(found, poses).maxCoeff() < 1e-5);
  CHECK((found.base.matrix() - as_specified.base().matrix()).norm() < 1e-5);
  for (std::size_t t = 0; t < 2; ++t)
    CHECK((found.targets_mm[t] - as_specified.robot().targets_mm[t]).norm() < 1e-5);
}

TEST_CASE("The more of a built arm is let go, the less is left", "[arm_fit]") {
  auto world = tracker();
  world.noise = {};
  const auto built = arm_with(world, 5);
  const auto poses = built.poses(40);
  auto arm = placed_robustly(built.robot().specified, Freedom::frames, poses, 1);
  std::vector<double> left;
  for (std::size_t f = 0; f < kFreedoms; ++f) {
    arm = fitted(arm, static_cast<Freedom>(f), poses, ones(poses));
    left.push_back(distances_mm(arm, poses).norm());
  }
  CHECK(left[0] > left[1]);
  CHECK(left[1] > left[2]);
  CHECK(left[2] > left[3]);
  CHECK(left[0] > 1);
  CHECK(left[3] < 1e-5);
}

TEST_CASE("A few wrong poses do not lead a fit from anywhere astray", "[arm_fit]") {
  const auto built = arm_with(tracker(), 6);
  auto poses = built.poses(40);
  for (std::size_t i = 0; i < poses.size(); i += 20)
    poses[i].sample.position_mm += Eigen::Vector3d(300, -200, 100);
  const auto found = placed_robustly(built.robot().specified, Freedom::zeros, poses, 1);
  CHECK(middle_of(distances_mm(found, poses)) < 2);
}

TEST_CASE("A placed arm's chain has its targets where the arm has them", "[arm_fit]") {
  const auto built = arm_with(tracker(), 7, 2);
  const PlacedArm placed{built.robot().arm, built.base(), built.robot().targets_mm};
  const Chain chain = placed.chain();
  for (const Pose& pose : built.poses(5)) {
    Turns turns{};
    for (std::size_t j = 0; j < chain.axes.size(); ++j)
      turns[j] = pose.sample.angles_rad[j] - placed.arm.home_rad[j];
    CHECK((chain.target_mm(pose.target, turns) - placed.position_mm(pose.target, pose.sample))
              .norm() < 1e-9);
  }
}

TEST_CASE("The level table is that of differences, on poses that were kept back", "[arm_fit]") {
  const auto built = arm_with(tracker(), 8);
  auto poses = built.poses(90);
  const std::vector<Pose> held(poses.begin() + 50, poses.end());
  poses.resize(50);
  const auto found = estimated(poses, built.campaign());
  REQUIRE(found);
  const auto oracle = simulation::levels_by_differences(found->levels.front().arm, poses, held);
  for (std::size_t k = 0; k < oracle.size(); ++k) {
    const Left left = left_of(distances_mm(found->levels[k].arm, held));
    CHECK(left.mean_mm == Approx(oracle[k].mean_mm).margin(1e-5));
    CHECK(left.rms_mm == Approx(oracle[k].rms_mm).margin(1e-5));
    CHECK(left.most_mm == Approx(oracle[k].most_mm).margin(1e-5));
  }
}
