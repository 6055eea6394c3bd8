#include <cmath>
#include <random>

#include "identify/identification.hpp"
#include "identify/poses/pose_stands.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/judged_poses.hpp"

using namespace identify;
using namespace simulation::robots;

TEST_CASE("What gears are off at a place is told once, however often the arm rests there",
          "[pose_estimate][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 16; ++seed) {
    const auto built = arm_with(with_gears(10), seed);
    const auto found = identify::identify(built.sweeps(), built.campaign(), rests(built));
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    REQUIRE(found.estimator == Estimator::poses);
    judge(built, found, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
}

TEST_CASE("What joints are off at a rest is told once, however many targets are seen there",
          "[pose_estimate][pose_stands][long]") {
  Judged all;
  auto world = tracker();
  world.decimals = 2;  // what rounding takes of the angles, all targets of a rest share
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto built = arm_with(world, seed, 3);
    const auto found = identify::identify({}, built.campaign(), seen_together(built, 100, seed));
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    CHECK_FALSE(found.poses->drift.seen);
    judge(built, found, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.9);
  CHECK(all.farthest < 4);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
}

TEST_CASE("Rests that stand near each other by chance are not off alike",
          "[pose_estimate][pose_stands][long]") {
  constexpr double kOff_rad = 20 * kArcsec;  // anew at each rest
  Judged all;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const auto built = arm_with(tracker(), seed, 3);
    const auto stands = seen_together(built, 100, seed);
    std::mt19937 random(seed);
    std::normal_distribution<> off(0, kOff_rad);
    std::vector<std::vector<double>> stood;
    for (std::size_t i = 0; i < stands.size(); ++i) {
      if (i % 3 > 0) {
        stood.push_back(stood.back());
        continue;
      }
      stood.push_back(angles_of(stands[i].sample));
      for (double& angle : stood.back()) angle += off(random);
    }
    auto poses = built.poses_at(stood);
    for (std::size_t i = 0; i < poses.size(); ++i)
      poses[i].sample.angles_rad = stands[i].sample.angles_rad;
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    CHECK(found.poses->effects.empty());
    CHECK_FALSE(found.poses->drift.seen);
    CHECK(found.poses->fit.noise.joint_rad == Approx(kOff_rad).epsilon(0.1));
    judge(built, found, all);
  }
  // Of a hundred numbers three standard deviations below 95 %.
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.89);
  CHECK(all.farthest < 4);
}

TEST_CASE("Joints that play are told by the sense in which they came to rest",
          "[pose_estimate][long]") {
  Judged all;
  double told = 0, untold = 0;  // variances
  for (std::uint32_t seed = 1; seed <= 16; ++seed) {
    const auto built = arm_with(tracker(), seed);
    auto poses = played(rests(built), built.robot().arm.joints(), 15 * kArcsec, seed);
    const auto found = identify::identify(built.sweeps(), built.campaign(), poses);
    REQUIRE(found.estimator == Estimator::poses);
    CHECK(found.poses->fit.noise.play_rad == Approx(15 * kArcsec).margin(3 * kArcsec));
    judge(built, found, all);
    told += found.dh_covariance.trace();
    for (Pose& pose : poses) pose.senses = {};
    const auto blind = identify::identify(built.sweeps(), built.campaign(), poses);
    untold += blind.dh_covariance.trace();
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
  CHECK(told < 0.8 * untold);
}

TEST_CASE("Ellipsoids hold poses of which nobody knows how joints that play came to rest",
          "[pose_estimate]") {
  const auto built = arm_with(tracker(), 3);
  auto poses = played(built.poses(160), built.robot().arm.joints(), 15 * kArcsec, 3);
  const std::vector<Pose> fitted_ones(poses.begin(), poses.begin() + 60);
  const auto found = estimated(fitted_ones, built.campaign());
  REQUIRE(found);
  int inside = 0, known = 0;
  for (auto pose = poses.begin() + 60; pose != poses.end(); ++pose) {
    const auto holds = [&] {
      const Eigen::Vector3d off = pose->sample.position_mm - found->fit.model.position_mm(*pose);
      return off.dot(found->covariance_at(*pose).inverse() * off) < 7.815;
    };
    if (holds()) ++known;
    pose->senses = {};
    if (holds()) ++inside;
  }
  CHECK(known > 88);
  CHECK(inside > 88);
}
