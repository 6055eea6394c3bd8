#include "identify/poses/pose_fit.hpp"

#include <algorithm>

#include "identify/poses/arm_fit.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

/// The true arm in the measurement frame.
PoseModel true_model(const simulation::Simulation& of) {
  PoseModel model;
  model.chain = PlacedArm{of.robot().arm, of.base(), of.robot().targets_mm}.chain();
  model.home_rad = of.robot().arm.home_rad;
  model.loads = {{10, 2, of.base() * Eigen::Vector3d(400, 300, 900)}};
  model.chain.up = of.base().linear().col(2);
  return model;
}

}  // namespace

TEST_CASE("Rows change with parameters as differences have it", "[pose_rows]") {
  const auto built = arm_with(tracker(), 3, 2);
  PoseModel model = true_model(built);
  for (const auto kind : {JointEffect::Kind::once, JointEffect::Kind::twice,
                          JointEffect::Kind::weight, JointEffect::Kind::compliance}) {
    JointEffect effect{kind, 1, kind == JointEffect::Kind::weight ? std::size_t{2} : 0};
    // How levers and torques change with the axes is left out.
    if (effect.is_wheel()) effect.size << 1e-3, 2e-3;
    model.effects.push_back(effect);
  }
  auto pose = built.poses(2).back();
  model.places.push_back({2, model.told(pose.sample)[2], 1e-3});
  pose.sample.has_orientation = true;
  const PoseRow row = pose_row(model, pose, true);
  for (Eigen::Index p = 0; p < model.parameters(); ++p) {
    constexpr double kStep = 1e-6;
    Eigen::VectorXd by = Eigen::VectorXd::Zero(model.parameters());
    by(p) = kStep;
    const auto above = pose_row(moved(model, by), pose, true).off;
    by(p) = -kStep;
    const auto below = pose_row(moved(model, by), pose, true).off;
    // What is seen stays: what is off falls as the model rises. Large rotations are not vectors.
    const Eigen::Vector3d seen = (below - above).head<3>() / (2 * kStep);
    INFO("parameter " << p);
    CHECK((seen - row.by_parameter.col(p).head<3>()).norm() <
          1e-4 * std::max(1.0, row.by_parameter.col(p).norm()));
  }
}

TEST_CASE("The sizes of noise are those of the world", "[pose_fit]") {
  double position = 0, joint = 0;
  constexpr int kRuns = 10;
  for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
    const auto built = arm_with(tracker(0.003), seed);
    PoseNoise start;
    start.position_mm = 0.1;
    start.joint_rad = 1e-4;
    const auto fit = fitted(true_model(built), start, built.poses(80), false, {});
    REQUIRE(fit.converged);
    position += fit.noise.position_mm / kRuns;
    joint += fit.noise.joint_rad / kDegree / kRuns;
  }
  CHECK(position == Approx(0.02).epsilon(0.15));
  CHECK(joint == Approx(0.003).epsilon(0.08));
}

TEST_CASE("A pose that is far off loses its weight, others keep it", "[pose_fit]") {
  const auto built = arm_with(tracker(), 2);
  auto poses = built.poses(40);
  poses[7].sample.position_mm.x() += 0.4;
  PoseNoise start;
  start.position_mm = 0.1;
  start.joint_rad = 1e-5;
  const auto fit = fitted(true_model(built), start, poses, false, {});
  CHECK(fit.converged);
  CHECK(fit.weights(7) == 0);
  CHECK(fit.weights.sum() > 38.5);
  CHECK(fit.sigmas_off(7) > 10);
}

TEST_CASE("Without noise a built arm is found to rounding", "[pose_fit]") {
  auto world = tracker();
  world.noise = {};
  const auto built = arm_with(world, 8);
  const auto poses = built.poses(40);
  const auto arm = placed_robustly(built.robot().specified, Freedom::zeros, poses, 1);
  PoseModel start;
  start.chain = arm.chain();
  start.home_rad = arm.arm.home_rad;
  PoseNoise noise;
  noise.position_mm = 0.1;
  noise.joint_rad = 1e-4;
  const auto fit = fitted(start, noise, poses, false, {});
  double most = 0;
  for (const Pose& pose : built.poses(40, 120))
    most = std::max(most, (pose.sample.position_mm - fit.model.position_mm(pose)).norm());
  CHECK(most < 1e-3);
}
