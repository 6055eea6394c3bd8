#include "identify/poses/pose_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/identification.hpp"
#include "identify/poses/pose_start.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/judged_poses.hpp"

using namespace identify;
using namespace simulation::robots;

TEST_CASE("Poses alone tell the table, and their uncertainties hold", "[pose_estimate][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    const auto built = arm_with(tracker(seed % 2 == 0 ? 0.002 : 0), seed);
    const auto found = identify::identify({}, built.campaign(), built.poses(40));
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    REQUIRE(found.estimator == Estimator::poses);
    judge(built, found, all);
  }
  const double share = static_cast<double>(all.inside) / all.numbers;
  CHECK(all.numbers > 400);
  CHECK(share > 0.92);
  CHECK(share < 0.98);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.1));
}

TEST_CASE("Gears do not take up all noise of a few poses", "[pose_estimate][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const auto built = arm_with(tracker(), seed);
    const auto poses = built.poses(12);
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.estimator == Estimator::poses);
    judge(built, found, all);
    const PoseFit& fit = found.poses->fit;
    double square = 0;  // of the noise in each coordinate, on average
    for (const PoseRow& row : fit.rows)
      square += fit.noise.covariance(row.by_own).trace() / 3 / static_cast<double>(poses.size());
    CHECK(std::sqrt(square) > 0.005);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(all.farthest < 6);
}

TEST_CASE("Ellipsoids hold what was not fitted", "[pose_estimate][long]") {
  int inside = 0, count = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const auto built = arm_with(tracker(0.002), seed);
    auto poses = built.poses(90);
    const std::vector<Pose> held(poses.begin() + 40, poses.end());
    poses.resize(40);
    const auto found = estimated(poses, built.campaign());
    REQUIRE(found);
    for (const Pose& pose : held) {
      const Eigen::Vector3d off = pose.sample.position_mm - found->fit.model.position_mm(pose);
      ++count;
      if (off.dot(found->covariance_at(pose).inverse() * off) < 7.815) ++inside;
    }
  }
  const double share = static_cast<double>(inside) / count;
  CHECK(share > 0.92);
  CHECK(share < 0.98);
}

TEST_CASE("Gears whose errors no test finds are in the uncertainties of poses",
          "[pose_estimate][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    const auto built = arm_with(with_gears(10), seed);
    const auto found = identify::identify({}, built.campaign(), built.poses(40));
    REQUIRE(found.estimator == Estimator::poses);
    judge(built, found, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
}

TEST_CASE("What makes up the uncertainty adds up to it", "[pose_estimate]") {
  const auto built = arm_with(with_gears(10), 3);
  auto poses = built.poses(40);
  for (Pose& rest : rests(built)) poses.push_back(std::move(rest));
  const auto found = estimated(poses, built.campaign());
  REQUIRE(found);
  REQUIRE_FALSE(found->fit.model.places.empty());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(found->chain.covariance.rows());
  for (const auto& part : found->chain.parts) sum += part.covariance.diagonal();
  for (Eigen::Index i = 0; i < 36; ++i)
    CHECK(sum(i) == Approx(found->chain.covariance(i, i)).epsilon(1e-3).margin(1e-15));
}

TEST_CASE("The covariance of the model is that of the table, whatever makes it uncertain",
          "[pose_estimate][pose_drift][pose_step][long]") {
  const auto built = arm_with(tracker(), 3, 2);
  const auto check = [&](const PoseEstimate& found) {
    const Eigen::MatrixXd map = to_estimate(found.chain.chain, found.fit.with_orientation);
    const Eigen::MatrixXd mapped =
        map * found.whole_covariance().topLeftCorner(map.cols(), map.cols()) * map.transpose();
    for (std::size_t j = 0; j < found.chain.axes.size(); ++j) {
      const Eigen::Vector3d z = found.chain.chain.axes[j].direction;
      const auto at = static_cast<Eigen::Index>(6 * j);
      for (const Eigen::Index part : {at, at + 3}) {
        // Of a place only what is across the axis is one.
        const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - z * z.transpose();
        const Eigen::Matrix3d model = across * mapped.block<3, 3>(part, part) * across;
        const Eigen::Matrix3d table =
            across * found.chain.covariance.block<3, 3>(part, part) * across;
        CHECK((model - table).norm() <= 1e-6 * table.norm());
      }
    }
  };
  const auto poses = seen_together(built, 40, 3);
  const auto as_they_are = estimated(poses, built.campaign());
  REQUIRE(as_they_are);
  check(*as_they_are);
  auto moved = poses;
  for (std::size_t i = 60; i < moved.size(); ++i) moved[i].sample.position_mm.x() += 0.1;
  const auto stepped = estimated(moved, built.campaign());
  REQUIRE(stepped);
  CHECK(stepped->step.seen);
  check(*stepped);
  auto slipped = poses;
  for (std::size_t i = 40; i < slipped.size(); ++i)
    slipped[i].sample.angles_rad[3] += 0.02 * kDegree;
  const auto drifted = estimated(slipped, built.campaign());
  REQUIRE(drifted);
  CHECK(drifted->drift.seen);
  check(*drifted);
  auto plays = played(poses, 6, 15 * kArcsec, 3);
  plays.front().senses = {};
  const auto played_by = estimated(plays, built.campaign());
  REQUIRE(played_by);
  CHECK(played_by->fit.noise.play_rad > 0);
  check(*played_by);
}

TEST_CASE("Angles from 0 to 360 degrees are those from -180 to 180", "[pose_estimate][long]") {
  const auto built = arm_with(tracker(), 3);
  auto poses = built.poses(40);
  for (Pose& rest : rests(built)) poses.push_back(std::move(rest));
  const auto found = identify::identify({}, built.campaign(), poses);
  for (Pose& pose : poses)
    for (std::size_t j = 0; j < 6; ++j)
      if (pose.sample.angles_rad[j] < 0) pose.sample.angles_rad[j] += 2 * kPi;
  const auto wrapped_ones = identify::identify({}, built.campaign(), poses);
  CHECK(wrapped_ones.status == found.status);
  REQUIRE(wrapped_ones.poses);
  CHECK(wrapped_ones.poses->fit.model.places.size() == found.poses->fit.model.places.size());
  for (std::size_t i = 0; i < found.dh.size(); ++i) {
    CHECK(wrapped_ones.dh[i].a_mm.value == Approx(found.dh[i].a_mm.value).margin(1e-6));
    CHECK(wrapped_ones.dh[i].a_mm.sigma == Approx(found.dh[i].a_mm.sigma).epsilon(1e-6));
  }
}

TEST_CASE("Poses that were computed leave no noise, and the fit comes to its end",
          "[pose_estimate]") {
  simulation::World world = simulation::robots::tracker();
  world.noise = {};
  world.decimals = 4;
  const auto built = arm_with(world, 2);
  auto poses = built.poses(40);
  for (Pose& rest : rests(built)) poses.push_back(std::move(rest));
  for (const auto& some : {poses, rests(built)}) {
    const auto found = estimated(some, built.campaign());
    REQUIRE(found);
    CHECK(found->fit.converged);
  }
}

TEST_CASE("Angles of few decimals do not make a device's poses the controller's own",
          "[pose_estimate][long]") {
  for (const bool device : {false, true})
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      auto world = tracker(device ? 0.005 : 0);
      world.noise.range_mm = world.noise.across_mm = device ? 0.05 : 0;
      world.noise.decimals = 4;
      world.decimals = 2;
      const auto built = arm_with(world, seed);
      auto campaign = built.campaign();
      campaign.resolution = {1e-4, 0.01 * kDegree};
      const auto found = estimated(built.poses(40), campaign);
      REQUIRE(found);
      INFO("device " << device << ", seed " << seed);
      CHECK(found->computed == !device);
    }
}

TEST_CASE("Distances between targets tell a device, however few decimals the angles have",
          "[pose_estimate][long]") {
  for (const bool device : {false, true})
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      auto world = tracker();
      world.noise.range_mm = world.noise.across_mm = device ? 0.01 : 0;
      world.noise.decimals = 4;
      world.decimals = 2;
      const auto built = arm_with(world, seed, 3);
      auto campaign = built.campaign();
      campaign.resolution = {1e-4, 0.01 * kDegree};
      const auto found = estimated(seen_together(built, 20, seed), campaign);
      REQUIRE(found);
      INFO("device " << device << ", seed " << seed);
      CHECK(found->computed == !device);
    }
}

TEST_CASE("Poses that were visited again and again are counted once", "[pose_estimate]") {
  const auto built = arm_with(tracker(0.001), 1);
  std::vector<std::vector<double>> angles_rad;
  for (int visit = 0; visit < 7; ++visit)
    for (const Pose& pose : built.poses(8))
      angles_rad.emplace_back(pose.sample.angles_rad.begin(),
                              pose.sample.angles_rad.begin() + pose.sample.joints);
  const auto found = identify::identify({}, built.campaign(), built.poses_at(angles_rad));
  CHECK(found.status == Status::failed);
  CHECK_THAT(found.reason, Catch::Matchers::ContainsSubstring("8 different poses give 24 numbers"));
}

TEST_CASE("Uncertainties hold of poses amid which a joint slipped",
          "[pose_estimate][pose_drift][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const auto built = arm_with(tracker(0.001), seed);
    auto poses = built.poses(60);
    for (std::size_t i = poses.size() / 2; i < poses.size(); ++i)
      poses[i].sample.angles_rad[3] += 0.02 * kDegree;
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed);
    REQUIRE(found.poses);
    CHECK(found.poses->drift.seen);
    double parts = 0;
    for (const auto& part : found.poses->chain.parts) parts += part.covariance.trace();
    CHECK(parts == Approx(found.poses->chain.covariance.trace()).epsilon(1e-6));
    judge(built, found, all);
  }
  CHECK(all.farthest < 4);
}

TEST_CASE("Thirty poses are not few, whatever their gears do", "[pose_estimate]") {
  const auto built = arm_with(with_gears(10), 4);
  const auto found = identify::identify({}, built.campaign(), built.poses(30));
  REQUIRE(found.poses);
  CHECK(std::none_of(found.warnings.begin(), found.warnings.end(),
                     [](const Warning& warning) { return warning.code == "few_poses"; }));
}

TEST_CASE("Too few poses, and poses without anything to start from, are refused with the reason",
          "[pose_estimate]") {
  const auto built = arm_with(tracker(), 1);
  auto found = identify::identify({}, built.campaign(), built.poses(8));
  CHECK(found.status == Status::failed);
  CHECK_THAT(found.reason, Catch::Matchers::ContainsSubstring("8 poses give 24 numbers"));
  auto campaign = built.campaign();
  campaign.specified.reset();
  found = identify::identify({}, campaign, built.poses(40));
  CHECK(found.status == Status::failed);
  CHECK_THAT(found.reason, Catch::Matchers::ContainsSubstring("description"));
}

TEST_CASE("Poses all alike leave the table open, and say so", "[pose_estimate]") {
  const auto built = arm_with(tracker(), 1);
  const auto found = identify::identify({}, built.campaign(), built.poses(40, 0.5));
  CHECK(found.status != Status::complete);
  for (const auto& row : found.dh)
    for (const auto* number : numbers_of(row))
      if (number->knowledge == Knowledge::identified) CHECK(number->sigma < 1000);
}

TEST_CASE("A target on the last axis leaves that axis open, and no other", "[pose_estimate]") {
  auto robot = simulation::built(simulation::kr5(), 2);
  robot.targets_mm = {{0.1, 0, 215}};
  const simulation::Simulation built(robot, strokes(10), tracker(), 2);
  const auto found = identify::identify({}, built.campaign(), built.poses(60));
  CHECK(found.status == Status::partial);
  for (std::size_t j = 0; j < 5; ++j) CHECK(found.joints[j].axis);
  CHECK_FALSE(found.joints[5].axis);
  const bool said = std::any_of(found.warnings.begin(), found.warnings.end(), [](const auto& one) {
    return one.code == "target_near_axis" && one.joint == 5;
  });
  CHECK(said);
}
