#include "identify/change/displacement.hpp"

#include <algorithm>

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/change/measured_arms.hpp"
#include "tests/simulation/simulation.hpp"

using namespace identify;
using identify::test::measured;
using simulation::Robot;

namespace {

ToolReach reach_of(const Robot& robot) {
  ToolReach reach;
  reach.linear.assign(robot.arm.joints(), false);
  reach.ranges.assign(robot.arm.joints(), {-kPi / 2, kPi / 2});
  reach.tool_mm = transform(robot.arm.rows.back()) * robot.targets_mm.front();
  return reach;
}

/// What a tracker's sweeps tell of a KR 5 as built by `seed`.
MeasuredArm found_by(const simulation::Strokes& strokes, std::uint32_t seed, std::uint32_t noise) {
  simulation::World world;
  world.placed = world.angles = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  const simulation::Simulation campaign(simulation::built(simulation::kr5(), seed), strokes, world,
                                        noise);
  const Identification found = identify::identify(campaign.sweeps(), campaign.campaign());
  INFO(found.reason);
  REQUIRE(found.status == Status::complete);
  MeasuredArm arm;
  arm.dh = found.dh;
  arm.covariance = found.dh_covariance;
  arm.positive = campaign.robot().arm.positive;
  arm.home_rad = found.home_rad;
  arm.gear.assign(found.dh.size(), 0);
  return arm;
}

}  // namespace

TEST_CASE("a zero that is off moves the tool by its lever", "[displacement]") {
  const Robot robot = simulation::built(simulation::kr5(), 3);
  Robot off = robot;
  constexpr double kOff_rad = 0.02 * kDegree;
  off.arm.rows[3].theta_rad += kOff_rad;
  const auto arms = compared(measured(robot), measured(off));
  const auto reach = reach_of(robot);
  const auto found = largest_displacement(arms, arms.difference, arms.covariance(), reach);
  // Whatever base and tool are fitted to, some pose is off by no less than half of what its
  // joint's lever makes, and none by more than twice.
  const auto lever = [&](const std::vector<double>& turns) {
    std::vector<double> angles = robot.arm.home_rad;
    for (std::size_t j = 0; j < angles.size(); ++j) angles[j] += turns[j];
    return (forward_kinematics(off.arm, angles) * robot.targets_mm[0] -
            forward_kinematics(robot.arm, angles) * robot.targets_mm[0])
        .norm();
  };
  CHECK(found.largest_mm > 0.5 * lever(found.turns_rad));
  CHECK(found.largest_mm < 2 * lever(found.turns_rad));
  CHECK(found.low_mm < found.largest_mm);
  CHECK(found.high_mm - found.largest_mm == Approx(found.largest_mm - found.low_mm));
  // Twice the change, twice the displacement: it is to first order; the band stays.
  const auto twice = largest_displacement(arms, 2 * arms.difference, arms.covariance(), reach);
  CHECK(twice.largest_mm == Approx(2 * found.largest_mm));
  CHECK(twice.high_mm - twice.largest_mm == Approx(found.high_mm - found.largest_mm));
  // With few poses to search from it is hardly another.
  const auto few = largest_displacement(arms, arms.difference, arms.covariance(), reach, 300);
  CHECK(few.largest_mm == Approx(found.largest_mm).epsilon(0.05));
  const auto none = largest_displacement(arms, 0 * arms.difference, arms.covariance(), reach);
  CHECK(none.largest_mm == 0);
}

TEST_CASE("what base and tool can take up is no displacement", "[displacement]") {
  // The first link of the arm, longer: as if the base stood elsewhere, but for where joint 1 turns.
  const Robot robot = simulation::kr5();
  const auto arms = compared(measured(robot), measured(robot));
  auto reach = reach_of(robot);
  const auto by = [&](ArmNumberKind kind, std::size_t joint, double size) {
    Eigen::VectorXd difference = Eigen::VectorXd::Zero(arms.difference.size());
    for (std::size_t k = 0; k < arms.numbers.size(); ++k)
      if (arms.numbers[k].kind == kind && arms.numbers[k].joint == joint)
        difference(static_cast<Eigen::Index>(k)) = size;
    return largest_displacement(arms, difference, arms.covariance(), reach).largest_mm;
  };
  const double turning = by(ArmNumberKind::a, 0, 1);
  CHECK(turning > 0.3);
  reach.ranges[0] = {-1e-3, 1e-3};  // joint 1 stands: the link's length is the base's place
  CHECK(by(ArmNumberKind::a, 0, 1) < 0.01);
}

TEST_CASE("a tool that would be metres longer takes up nothing", "[displacement]") {
  // Three upright axes, a tenth of a degree off parallel, and a zero that is off by 0.3 degrees.
  const auto arm = [](double tilt_deg, double off_deg) {
    const auto upright = [&](double x, double tilted) {
      Axis axis{Eigen::Vector3d(0, tilted * kDegree, 1).normalized(), {x, 0, 0}};
      axis.covariance = 1e-10 * Eigen::Matrix<double, 6, 6>::Identity();
      return axis;
    };
    MeasuredArm measured;
    measured.dh = extract_dh({upright(0, 0), upright(325, tilt_deg), upright(600, -tilt_deg)}, 600);
    measured.dh[1].theta_rad.value += off_deg * kDegree;
    measured.covariance = 1e-10 * Eigen::MatrixXd::Identity(15, 15);
    measured.positive.assign(3, 1);
    measured.home_rad.assign(3, 0);
    measured.gear.assign(3, 0);
    return measured;
  };
  ToolReach reach;
  reach.linear.assign(3, false);
  reach.ranges.assign(3, {-150 * kDegree, 150 * kDegree});
  reach.tool_mm = {80, 0, 0};
  const auto moved = [&](double tilt_deg) {
    const auto arms = compared(arm(tilt_deg, 0), arm(tilt_deg, 0.3));
    Eigen::VectorXd zero = 0 * arms.difference;
    for (std::size_t k = 0; k < arms.numbers.size(); ++k)
      if (arms.numbers[k].kind == ArmNumberKind::zero && arms.numbers[k].joint == 1)
        zero(static_cast<Eigen::Index>(k)) = 0.3 * kDegree;
    return largest_displacement(arms, zero, arms.covariance(), reach).largest_mm;
  };
  const double upright = moved(0);
  CHECK(upright > 1);
  for (const double tilt_deg : {0.01, 0.1, 0.3}) {
    CAPTURE(tilt_deg);
    CHECK(moved(tilt_deg) == Approx(upright).epsilon(0.1));
  }
}

TEST_CASE("an axis that is known to half a degree makes no change of what is known well",
          "[displacement][long]") {
  simulation::Strokes all, little;
  little.ranges_deg.assign(6, {-45, 45});
  little.ranges_deg[3] = {-3, 3};
  constexpr std::uint32_t kPairs = 10;
  double most = 0;
  for (std::uint32_t seed = 1; seed <= kPairs; ++seed) {
    const Robot robot = simulation::built(simulation::kr5(), seed);
    const auto arms = compared(found_by(all, seed, seed), found_by(little, seed, 100 + seed));
    const auto count = static_cast<double>(arms.difference.size());
    CHECK(count >= 16);
    const Eigen::VectorXd bend = second_order(arms, reach_of(robot));
    const Eigen::MatrixXd covariance = arms.covariance() + bend * bend.transpose();
    most = std::max(most, arms.difference.dot(covariance.llt().solve(arms.difference)) / count);
  }
  CHECK(most < 2.5);  // one in 1,000 of chi squared with so many degrees of freedom
}
