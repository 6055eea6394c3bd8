#include "identify/correction/controller_fit.hpp"

#include <cmath>
#include <random>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"

using namespace identify;
using namespace simulation::robots;
using Kind = ControllerNumber::Kind;
using Verdict = ControllerNumber::Verdict;

namespace {

Eigen::VectorXd all_of(const std::vector<Pose>& poses) {
  return Eigen::VectorXd::Ones(static_cast<Eigen::Index>(poses.size()));
}

ControllerFit fitted_at(ControllerLevel level, const simulation::Simulation& of,
                        const std::vector<Pose>& poses) {
  const PlacedArm start =
      placed_robustly(of.robot().specified, Freedom::frames, poses, of.robot().targets_mm.size());
  return fitted_controller(start, level, poses, all_of(poses));
}

/// A KR 5 as specified but for what `change` does to it.
template <typename Change>
simulation::Simulation kr5_but(const Change& change, std::uint32_t seed) {
  auto robot = simulation::kr5();
  change(robot.arm);
  return {robot, strokes(10), tracker(), seed};
}

const ControllerNumber& number(const ControllerFit& found, Kind kind, std::size_t joint) {
  for (const auto& one : found.numbers)
    if (one.kind == kind && one.joint == joint) return one;
  throw std::out_of_range("no such number");
}

}  // namespace

TEST_CASE("Zeros that are off are found with their sign, and no others", "[controller_fit]") {
  int false_ones = 0, inside = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto built = kr5_but([](Arm& arm) { arm.rows[2].theta_rad += 0.05 * kDegree; }, seed);
    const auto found = fitted_at(ControllerLevel::mastering, built, built.poses(60));
    REQUIRE(found.numbers.size() == 6);
    for (const std::size_t end : {0UL, 5UL})  // the base and the tool take them up
      CHECK(number(found, Kind::zero, end).verdict == Verdict::inseparable);
    const auto& third = number(found, Kind::zero, 2);
    CHECK(third.taken());
    if (std::abs(third.change - 0.05 * kDegree) < 2 * third.sigma) ++inside;
    for (const std::size_t j : {1UL, 3UL, 4UL}) {
      if (number(found, Kind::zero, j).taken()) ++false_ones;
      CHECK(number(found, Kind::zero, j).sigma > 0);
    }
    // What is not significant stays as specified to the last digit.
    if (!number(found, Kind::zero, 3).taken())
      CHECK(found.arm.arm.rows[3].theta_rad == built.robot().specified.rows[3].theta_rad);
  }
  CHECK(false_ones <= 3);  // 5 % of 20, and two sigma of that
  CHECK(inside >= 17);
}

TEST_CASE("Machine data keep the controller's structure", "[controller_fit]") {
  const auto built = arm_with(tracker(), 4);
  const auto found = fitted_at(ControllerLevel::machine_data, built, built.poses(80));
  const Arm& specified = built.robot().specified;
  for (std::size_t j = 0; j < 6; ++j) {
    const DhRow& row = found.arm.arm.rows[j];
    CHECK(row.alpha_rad == specified.rows[j].alpha_rad);
    CHECK(row.beta_rad == 0);
    if (specified.rows[j].a_mm == 0) CHECK(row.a_mm == 0);
    if (specified.rows[j].b_mm == 0) CHECK(row.b_mm == 0);
  }
  CHECK(number(found, Kind::b, 0).verdict == Verdict::inseparable);  // the base's height
  CHECK(number(found, Kind::a, 1).taken());
  const auto frames = fitted_at(ControllerLevel::frames, built, built.poses(80));
  CHECK(frames.numbers.empty());
  const auto zeros = fitted_at(ControllerLevel::mastering, built, built.poses(80));
  CHECK(zeros.left.rms_mm < frames.left.rms_mm);
  CHECK(found.left.rms_mm < zeros.left.rms_mm);
}

TEST_CASE("A number is as uncertain as those beside it that are left", "[controller_fit]") {
  std::normal_distribution<> normal;
  Spread z;
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    std::mt19937 random(seed);
    const auto built = kr5_but(
        [&](Arm& arm) {
          for (std::size_t j = 0; j < 5; ++j) {
            DhRow& row = arm.rows[j];
            row.theta_rad += 0.01 * kDegree * normal(random);
            if (row.a_mm != 0) row.a_mm += 0.05 * normal(random);
            if (row.b_mm != 0) row.b_mm += 0.05 * normal(random);
          }
        },
        seed);
    const auto found = fitted_at(ControllerLevel::machine_data, built, built.poses(40));
    const Arm &arm = built.robot().arm, &specified = built.robot().specified;
    for (const auto& one : found.numbers) {
      if (!one.taken()) continue;
      CHECK(std::abs(one.change) > 1.95 * one.sigma);
      const DhRow &row = arm.rows[one.joint], &meant = specified.rows[one.joint];
      const double off = one.kind == Kind::zero ? row.theta_rad - meant.theta_rad
                         : one.kind == Kind::a  ? row.a_mm - meant.a_mm
                                                : row.b_mm - meant.b_mm;
      z.add((one.change - off) / one.sigma);
    }
  }
  CHECK(z.sigma() < 1.2);
  CHECK(z.sigma() > 0.6);
}

TEST_CASE("An arm with only lengths off is held whole by its machine data", "[controller_fit]") {
  const auto built = kr5_but(
      [](Arm& arm) {
        arm.rows[1].a_mm += 0.4;
        arm.rows[3].b_mm -= 0.3;
      },
      7);
  const auto found = fitted_at(ControllerLevel::machine_data, built, built.poses(80));
  CHECK(number(found, Kind::a, 1).change == Approx(0.4).margin(0.03));
  CHECK(number(found, Kind::b, 3).change == Approx(-0.3).margin(0.03));
  CHECK(found.left.rms_mm < 1.1 * std::sqrt(3.0) * 0.02);
}

TEST_CASE("The uncertainty of frames is that of their scatter", "[controller_fit]") {
  Spread z;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const auto as_specified = kr5_but([](Arm&) {}, seed);
    const auto found = fitted_at(ControllerLevel::frames, as_specified, as_specified.poses(40));
    for (const bool determined : found.frames_determined) CHECK(determined);
    const auto sigma = found.frames_covariance.diagonal().cwiseSqrt();
    for (Eigen::Index k = 0; k < 3; ++k) {
      z.add((found.arm.base.translation() - as_specified.base().translation())(k) / sigma(k));
      z.add((found.arm.targets_mm[0] - as_specified.robot().targets_mm[0])(k) / sigma(6 + k));
    }
    const Eigen::AngleAxisd turn(found.arm.base.linear() *
                                 as_specified.base().linear().transpose());
    for (Eigen::Index k = 0; k < 3; ++k) z.add(turn.angle() * turn.axis()(k) / sigma(3 + k));
  }
  CHECK(z.sigma() == Approx(1).margin(0.15));
}

TEST_CASE("Poses that never move the wrist leave the tool open, and it is said",
          "[controller_fit]") {
  const auto built = kr5_but([](Arm&) {}, 3);
  auto poses = built.poses(40);
  PlacedArm truth{built.robot().specified, built.base(), built.robot().targets_mm};
  for (Pose& pose : poses) {
    for (std::size_t j = 3; j < 6; ++j) pose.sample.angles_rad[j] = truth.arm.home_rad[j];
    pose.sample.position_mm = truth.position_mm(0, pose.sample);
  }
  const auto found = fitted_controller(truth, ControllerLevel::mastering, poses, all_of(poses));
  for (const auto& one : found.numbers)
    if (one.joint >= 3) CHECK(one.verdict == Verdict::inseparable);
}
