#include "identify/poses/pose_effects.hpp"

#include <algorithm>

#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

const EffectEvidence* effect_of(const PoseEstimate& found, std::size_t joint,
                                JointEffect::Kind kind) {
  for (const auto& one : found.effects)
    if (one.effect.joint == joint && one.effect.kind == kind) return &one;
  return nullptr;
}

}  // namespace

TEST_CASE("A wheel off by 50 seconds of arc is found, with its size", "[pose_effects][long]") {
  auto world = tracker();
  world.gears.joint = 1;
  world.gears.first_arcsec = 50;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const auto built = arm_with(world, seed);
    const auto found = estimated(built.poses(120), built.campaign());
    REQUIRE(found);
    const auto* effect = effect_of(*found, 1, JointEffect::Kind::once);
    REQUIRE(effect != nullptr);
    CHECK(effect->effect.amplitude() / kArcsec == Approx(50).margin(12));
    CHECK(effect->chance < 1e-6);
  }
}

TEST_CASE("A wheel that is off is found beside joints that play", "[pose_effects][long]") {
  auto world = tracker();
  world.gears.joint = 1;
  world.gears.first_arcsec = 50;
  const auto built = arm_with(world, 2);
  const std::size_t joints = built.robot().arm.joints();
  const auto found = estimated(played(built.poses(120), joints, 15 * kArcsec, 2), built.campaign());
  REQUIRE(found);
  const auto* effect = effect_of(*found, 1, JointEffect::Kind::once);
  REQUIRE(effect != nullptr);
  CHECK(effect->effect.amplitude() / kArcsec == Approx(50).margin(12));
  CHECK(found->fit.noise.play_rad / kArcsec == Approx(15).margin(3));
  CHECK(found->effects.size() == 1);
  const auto& effects = found->fit.model.effects;
  CHECK(std::is_partitioned(effects.begin(), effects.end(),
                            [](const JointEffect& one) { return !one.assumed; }));
}

TEST_CASE("Joints that give way by their load are found where the loads are known",
          "[pose_effects][long]") {
  auto world = tracker();
  world.sag_arcsec = 100;
  const auto built = arm_with(world, 3);
  auto campaign = built.campaign();
  campaign.loads = built.loads();
  const auto poses = built.poses(120);
  const auto found = estimated(poses, campaign);
  REQUIRE(found);
  const auto* effect = effect_of(*found, 1, JointEffect::Kind::compliance);
  REQUIRE(effect != nullptr);
  const simulation::Sag sag(built.robot(), world.sag_arcsec * kArcsec);
  Turns out{};
  out[1] = 1;
  const double truth = sag.at(out)[1] / sag.torques(out)[1];
  CHECK(effect->effect.size(0) == Approx(truth).margin(4 * effect->sigma(0)));
  CHECK(effect->sigma(0) < 0.1 * truth);
  CHECK(mean_off(*found, poses) < 0.045);
}

TEST_CASE("Joints that give way to weights that nobody knows are told", "[pose_effects][long]") {
  auto world = tracker();
  world.sag_arcsec = 100;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const auto built = arm_with(world, seed);
    const auto poses = built.poses(120);
    const auto found = estimated(poses, built.campaign());
    REQUIRE(found);
    // The forearm bends both the joint that carries the upper arm, and its own.
    for (const std::size_t joint : {std::size_t{1}, std::size_t{2}}) {
      const auto* effect = effect_of(*found, joint, JointEffect::Kind::weight);
      REQUIRE(effect != nullptr);
      CHECK(effect->effect.carried == 2);
      CHECK(effect->effect.amplitude() > 20 * kArcsec);
    }
    CHECK(effect_of(*found, 2, JointEffect::Kind::once) == nullptr);
    CHECK(effect_of(*found, 2, JointEffect::Kind::twice) == nullptr);
    CHECK(mean_off(*found, poses) < 0.045);
  }
}

TEST_CASE("Joints of an arm on a wall give way that way", "[pose_effects][upright][long]") {
  auto world = tracker();
  world.sag_arcsec = 100;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    auto wall = robot(seed);
    wall.up = Eigen::Vector3d::UnitX();
    const simulation::Simulation built(wall, strokes(50), world, seed);
    const auto poses = built.poses(120);
    const auto found = estimated(poses, built.campaign());
    REQUIRE(found);
    const auto* effect = effect_of(*found, 1, JointEffect::Kind::weight);
    REQUIRE(effect != nullptr);
    CHECK(effect->effect.amplitude() > 20 * kArcsec);
    CHECK(effect_of(*found, 1, JointEffect::Kind::once) == nullptr);
    CHECK(effect_of(*found, 2, JointEffect::Kind::once) == nullptr);
    CHECK(mean_off(*found, poses) < 0.045);
  }
}

TEST_CASE("What loads do is not said to be wheels, too", "[pose_effects][long]") {
  auto world = tracker();
  world.sag_arcsec = 60;
  int wheels = 0, bent = 0;
  constexpr std::uint32_t kRuns = 20;
  for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
    const auto built = arm_with(world, seed);
    auto campaign = built.campaign();
    campaign.loads = built.loads();
    const auto found = estimated(built.poses(120), campaign);
    REQUIRE(found);
    const auto compliance = [](const EffectEvidence& one) {
      return one.effect.kind == JointEffect::Kind::compliance;
    };
    if (std::any_of(found->effects.begin(), found->effects.end(), compliance)) ++bent;
    if (!std::all_of(found->effects.begin(), found->effects.end(), compliance)) ++wheels;
  }
  CHECK(bent == static_cast<int>(kRuns));
  CHECK(wheels <= 2);  // one by chance is likely, the test's level is 2 % an arm
}

TEST_CASE("Arms without such effects have none", "[pose_effects][long]") {
  int invented = 0;
  constexpr std::uint32_t kRuns = 200;
  for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
    const auto built = arm_with(tracker(seed % 2 == 0 ? 0.002 : 0), seed);
    auto campaign = built.campaign();
    if (seed % 4 < 2) campaign.loads = built.loads();
    const auto found = estimated(built.poses(40 + seed % 3 * 30), campaign);
    REQUIRE(found);
    if (!found->effects.empty()) ++invented;
  }
  CHECK(invented <= 10);
}
