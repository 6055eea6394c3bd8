#include "identify/correction/combined_poses.hpp"

#include <algorithm>

#include "identify/correction/controller_fit.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"
#include "tests/identify/simulated_robots.hpp"

using namespace identify;
using namespace simulation::robots;

TEST_CASE("Combined poses are arms and wrists of measured ones, where the model has them",
          "[combined_poses]") {
  const auto built = arm_with(tracker(), 2);
  const auto poses = built.poses(50);
  const auto found = estimated(poses, built.campaign());
  REQUIRE(found);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(50);
  weights(7) = 0;
  const auto combined = combined_poses(found->fit.model, poses, weights);
  CHECK(combined.size() == 12 * 49);
  const auto same = [](const Pose& a, const Pose& b, std::size_t from, std::size_t to) {
    return std::equal(a.sample.angles_rad.begin() + static_cast<std::ptrdiff_t>(from),
                      a.sample.angles_rad.begin() + static_cast<std::ptrdiff_t>(to),
                      b.sample.angles_rad.begin() + static_cast<std::ptrdiff_t>(from));
  };
  for (const Pose& pose : combined) {
    CHECK_FALSE(same(pose, poses[7], 0, 3));
    CHECK_FALSE(same(pose, poses[7], 3, 6));
    const auto arm = std::find_if(poses.begin(), poses.end(),
                                  [&](const Pose& one) { return same(pose, one, 0, 3); });
    REQUIRE(arm != poses.end());
    CHECK_FALSE(same(pose, *arm, 3, 6));
    CHECK((pose.sample.position_mm - found->fit.model.position_mm(pose)).norm() == 0);
  }
  // More of them do not make a fit look better founded than its poses do.
  const auto start = placed_robustly(built.robot().specified, Freedom::frames, combined, 1);
  const auto by = [&](double weight) {
    return fitted_controller(start, ControllerLevel::frames, combined,
                             Eigen::VectorXd::Constant(12 * 49, weight));
  };
  CHECK(by(1.0 / 12).frames_covariance(0, 0) ==
        Approx(12 * by(1).frames_covariance(0, 0)).epsilon(0.1));
}

TEST_CASE("Frames and zeros do not make poses worse that were kept back",
          "[combined_poses][long]") {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto built = arm_with(tracker(seed % 2 == 0 ? 0.002 : 0), seed);
    auto poses = built.poses(560);
    const std::vector<Pose> held(poses.begin() + 60, poses.end());
    poses.resize(60);
    const auto estimate = estimated(poses, built.campaign());
    REQUIRE(estimate);
    const auto combined = combined_poses(estimate->fit.model, poses, Eigen::VectorXd::Ones(60));
    const Eigen::VectorXd weights = Eigen::VectorXd::Constant(600, 0.1);
    const auto left = [&](ControllerLevel level) {
      return distances_mm(
                 fitted_controller(estimate->levels.front().arm, level, combined, weights).arm,
                 held)
          .norm();
    };
    // As the robot came: its base known, its tool as drawn, its zeros as they are.
    const PlacedArm before{built.robot().specified, built.base(), built.robot().targets_mm};
    INFO("seed " << seed);
    const double frames = left(ControllerLevel::frames);
    CHECK(frames <= distances_mm(before, held).norm());
    CHECK(left(ControllerLevel::mastering) <= frames);
  }
}

TEST_CASE("What an identified arm is uncertain by is in what it asks of a controller",
          "[combined_poses][long]") {
  // An arm as specified: all that is asked for is by chance, and smooth over the poses.
  const int count = GENERATE(60, 200);
  Spread errors;
  int named = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const simulation::Simulation specified(simulation::kr5(), strokes(10), tracker(0.002), seed);
    const auto poses = specified.poses(static_cast<std::size_t>(count));
    const auto found = estimated(poses, specified.campaign());
    REQUIRE(found);
    const auto combined = combined_poses(found->fit.model, poses, Eigen::VectorXd::Ones(count));
    const auto size = static_cast<Eigen::Index>(combined.size());
    const auto fit =
        fitted_controller(found->levels.front().arm, ControllerLevel::machine_data, combined,
                          Eigen::VectorXd::Constant(size, count / static_cast<double>(size)),
                          {by_parameter(found->fit.model, combined), found->whole_covariance()});
    for (const ControllerNumber& number : fit.numbers) {
      if (number.verdict == ControllerNumber::Verdict::inseparable) continue;
      errors.add(number.change / number.sigma);
      named += number.taken();
    }
  }
  INFO(count << " poses: " << errors.sigma() << ", most " << errors.most);
  CHECK(errors.count >= 8 * 8);
  CHECK(errors.sigma() < 1.3);
  CHECK(named <= 1);
}
