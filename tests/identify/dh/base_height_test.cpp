#include "identify/dh/base_height.hpp"

#include <cmath>
#include <random>

#include "identify/given_axes.hpp"
#include "identify/identification.hpp"
#include "tests/bench/accuracy_campaign.hpp"
#include "tests/catch.hpp"
#include "tests/identify/linear_robots.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;
using Catch::Matchers::ContainsSubstring;
using identify::test::find_warning;

namespace {

/// Its first two axes are specified as parallel and are a little askew. With three joints the third
/// is square to them.
simulation::Robot arm_of(std::size_t joints) {
  simulation::Robot robot;
  robot.specified.rows = {{0, 1.2, -400, 0}, {0, 0, 0, 0}};
  if (joints == 3)
    robot.specified.rows = {{0, 1.2, -400, 0}, {-400, -1.1, 400, -kPi / 2}, {0, 0, 0, 0}};
  robot.specified.home_rad.assign(joints, 0);
  robot.specified.positive.assign(joints, 1);
  robot.arm = robot.specified;
  robot.arm.rows[0].a_mm += 0.4;
  robot.arm.rows[0].alpha_rad = 0.02 * kDegree;
  robot.arm.rows[0].beta_rad = -0.16 * kDegree;
  if (joints == 3) robot.arm.rows[1].b_mm += 0.3;
  robot.targets_mm = {{150, 60, 100}};
  return robot;
}

/// Swept by 90 degrees, before a device that stands somewhere, or in the robot's own frame.
Identification swept(std::size_t joints, bool placed, std::uint32_t seed) {
  simulation::Strokes strokes;
  strokes.samples = 200;
  auto world = accuracy::tracker(0.02);
  world.placed = placed;
  const simulation::Simulation simulation(arm_of(joints), strokes, world, seed);
  return identify::identify(simulation.sweeps(), simulation.campaign());
}

/// As a device has them that stands somewhere within metres.
std::vector<Axis> axes_before_a_device(const simulation::Robot& robot, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> any(-3000, 3000);
  const Eigen::AngleAxisd turn(any(random) / 1000,
                               Eigen::Vector3d(any(random), any(random), any(random)).normalized());
  const Eigen::Vector3d by(any(random), any(random), any(random));
  std::vector<Axis> axes;
  for (const ChainAxis& axis : chain_of(robot).axes) {
    axes.emplace_back();
    axes.back().direction = turn * axis.direction;
    axes.back().point_mm = turn * axis.point_mm + by;
    axes.back().linear = axis.linear;
  }
  return axes;
}

}  // namespace

TEST_CASE("b behind parallel first axes is nobody's number in a device's frame", "[height]") {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    INFO("seed " << seed);
    const auto found = swept(3, true, seed);
    CHECK(found.status == Status::complete);
    CHECK(found.doubts.empty());
    REQUIRE(found.dh.size() == 3);
    CHECK(found.dh[0].relation == Relation::parallel);
    CHECK(found.dh[1].b_mm.knowledge == Knowledge::by_convention);
    CHECK(found.dh[1].b_mm.value == Approx(-400).margin(1e-6));
    // At that height the others are the arm's.
    CHECK(found.dh[0].a_mm.knowledge == Knowledge::identified);
    CHECK(std::abs(found.dh[0].a_mm.value - -399.6) < 4.5 * found.dh[0].a_mm.sigma);
    CHECK(std::abs(wrapped(found.dh[1].theta_rad.value - -1.1)) <
          4.5 * found.dh[1].theta_rad.sigma);
    const Warning* const warning = find_warning(found, "height_unknown");
    REQUIRE(warning != nullptr);
    CHECK_THAT(warning->message, ContainsSubstring("b of row 2"));
  }
}

TEST_CASE("the length of a planar arm whose axes are askew is not identified without its height",
          "[height]") {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    INFO("seed " << seed);
    const auto found = swept(2, true, seed);
    CHECK(found.doubts.empty());
    REQUIRE(found.dh.size() == 2);
    CHECK(found.dh[0].a_mm.knowledge == Knowledge::by_convention);
    CHECK(found.dh[0].alpha_rad.knowledge == Knowledge::identified);
    // Level with the target, which is near the arm.
    CHECK(std::abs(found.dh[0].a_mm.value - -399.6) < 1);
    const Warning* const warning = find_warning(found, "height_unknown");
    REQUIRE(warning != nullptr);
    CHECK_THAT(warning->message,
               ContainsSubstring("not determined, and set as they are at that height: a of row 1"));
  }
}

TEST_CASE("in the robot's frame the height is told, and all is identified", "[height]") {
  const auto found = swept(3, false, 1);
  CHECK(found.status == Status::complete);
  REQUIRE(found.dh.size() == 3);
  CHECK(found.dh[0].a_mm.knowledge == Knowledge::identified);
  CHECK(found.dh[1].b_mm.knowledge == Knowledge::identified);
  CHECK(found.dh[1].b_mm.value == Approx(-399.7).margin(1));
  CHECK_FALSE(find_warning(found, "height_unknown"));
}

TEST_CASE("axes that are given in a device's frame leave the height open as well", "[height]") {
  Campaign campaign;
  campaign.device_frame = true;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    INFO("seed " << seed);
    const auto robot = arm_of(3);
    campaign.joints = 3;
    campaign.specified = robot.specified;
    const auto found = identify_given_axes(axes_before_a_device(robot, seed), campaign);
    CHECK(found.doubts.empty());
    CHECK(found.dh[1].b_mm.knowledge == Knowledge::by_convention);
    CHECK(found.dh[1].b_mm.value == Approx(-400).margin(1e-6));
    const Warning* const warning = find_warning(found, "height_unknown");
    REQUIRE(warning != nullptr);
    CHECK(warning->joint == 0U);
    CHECK_THAT(warning->message, ContainsSubstring("b of row 2 is as specified") &&
                                     ContainsSubstring("mm for each metre"));
    campaign.device_frame = false;
    CHECK_FALSE(find_warning(identify_given_axes(axes_before_a_device(robot, seed), campaign),
                             "height_unknown"));
    campaign.device_frame = true;
  }
}

TEST_CASE(
    "on the height of axes that are exactly parallel hangs no other number, and so it is told",
    "[height]") {
  Campaign campaign;
  campaign.device_frame = true;
  const auto told = [&](const simulation::Robot& robot, bool by_table) {
    campaign.joints = robot.specified.rows.size();
    campaign.specified.reset();
    if (by_table) campaign.specified = robot.specified;
    const auto found = identify_given_axes(axes_before_a_device(robot, 1), campaign);
    const Warning* const warning = find_warning(found, "height_unknown");
    return warning == nullptr ? "" : warning->message;
  };
  auto robot = arm_of(3);
  robot.arm.rows[0].alpha_rad = robot.arm.rows[0].beta_rad = 0;
  for (const bool by_table : {false, true}) {
    const auto message = told(robot, by_table);
    CHECK_THAT(message, ContainsSubstring("b of row 2") && ContainsSubstring("exactly parallel") &&
                            ContainsSubstring("No height changes them") &&
                            !ContainsSubstring("change by"));
  }
  auto planar = arm_of(2);
  planar.arm.rows[0].alpha_rad = planar.arm.rows[0].beta_rad = 0;
  CHECK_THAT(told(planar, true),
             ContainsSubstring("No height changes them") && !ContainsSubstring("change by"));
}

TEST_CASE("how much the height changes is told by the least parallel of the axes", "[height]") {
  simulation::Robot robot = arm_of(2);
  robot.specified.rows.push_back(robot.specified.rows.back());
  robot.specified.rows[1] = {0, -0.7, 300, 0};
  robot.specified.home_rad.assign(3, 0);
  robot.specified.positive.assign(3, 1);
  robot.arm = robot.specified;
  robot.arm.rows[1].beta_rad = 0.16 * kDegree;
  Campaign campaign;
  campaign.joints = 3;
  campaign.device_frame = true;
  campaign.specified = robot.specified;
  const auto found = identify_given_axes(axes_before_a_device(robot, 1), campaign);
  const Warning* const warning = find_warning(found, "height_unknown");
  REQUIRE(warning != nullptr);
  CHECK_THAT(warning->message, ContainsSubstring("2.8 mm for each metre"));  // of tan(0.16°)
}

TEST_CASE("the circles' table is stated from the same base as the chain's", "[height]") {
  // A device that stands 777 mm lower than the robot.
  const auto arm = identify::test::scara();
  auto samples = identify::test::Campaign(arm, {.position_mm = 0.02})
                     .rest()
                     .sweep(0, -25, 65)
                     .sweep(1, 15, 105)
                     .sweep(2, 20, 180)
                     .sweep(3, -75, 15)
                     .samples();
  for (Sample& sample : samples) sample.position_mm += Eigen::Vector3d(1000, -300, 777);
  Campaign campaign;
  campaign.joints = 4;
  campaign.specified = arm;
  campaign.device_frame = true;
  const auto found = identify::identify(identify::test::segment(samples, {}, 4), campaign);
  REQUIRE(found.estimator == Estimator::chain);
  REQUIRE(found.dh.size() == 4);
  REQUIRE(found.circle_dh.size() == 4);
  // The place of the linear joint at home tells where the base is by convention: as specified.
  CHECK(found.dh[2].b_mm.value == Approx(-120).margin(1e-3));
  CHECK(found.dh[2].b_mm.knowledge == Knowledge::by_convention);
  for (std::size_t i = 0; i < 4; ++i) {
    INFO("row " << i + 1);
    CHECK(found.circle_dh[i].b_mm.value == Approx(found.dh[i].b_mm.value).margin(0.5));
  }
  const Warning* const warning = find_warning(found, "height_unknown");
  REQUIRE(warning != nullptr);
  CHECK_THAT(warning->message, ContainsSubstring("b of row 3 is as specified"));
  REQUIRE(found.robot_pose);
  CHECK(found.robot_pose->pose.translation().z() == Approx(777).margin(1));
}

TEST_CASE("a SCARA's base is as high as the description has the target above the last frame",
          "[height]") {
  auto arm = identify::test::scara();
  arm.tool_mm.z() = 400;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const auto built = identify::test::as_built(arm, seed);
    auto sweeps = identify::test::scara_sweeps(built, {.position_mm = 0.02, .seed = seed});
    Campaign campaign = identify::test::for_arm(arm);
    campaign.device_frame = true;
    const auto found = identify::identify(sweeps, campaign);
    REQUIRE(found.estimator == Estimator::chain);
    REQUIRE(found.robot_pose);
    CHECK(found.robot_pose->pose.translation().z() == Approx(0).margin(1));
    for (std::size_t i = 0; i < 2; ++i) {
      INFO("row " << i + 1);
      const DhNumber& a = found.dh[i].a_mm;
      CHECK(a.value == Approx(built.rows[i].a_mm).margin(3 * a.sigma));
    }
    const DhNumber& theta = found.dh[1].theta_rad;
    CHECK(theta.value == Approx(built.rows[1].theta_rad).margin(3 * theta.sigma));
  }
}

TEST_CASE("on a lift X of the base is where theta is as specified, wherever a device stands",
          "[height]") {
  simulation::Robot robot;
  robot.specified = identify::test::on_lift();
  robot.arm = identify::test::as_built(robot.specified, 1);
  robot.targets_mm = {robot.specified.tool_mm};
  Campaign campaign;
  campaign.device_frame = true;
  campaign.joints = 4;
  campaign.specified = robot.specified;
  campaign.declared_home_rad = robot.specified.home_rad;
  std::vector<DhRow> before;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    INFO("seed " << seed);
    const auto found = identify_given_axes(axes_before_a_device(robot, seed), campaign);
    CHECK(found.doubts.empty());
    CHECK(found.dh[1].theta_rad.knowledge == Knowledge::by_convention);
    CHECK(found.dh[1].theta_rad.value == Approx(30 * kDegree).margin(1e-12));
    const auto rows = values(found.dh);
    for (std::size_t i = 0; i < before.size(); ++i) {
      CHECK(rows[i].alpha_rad == Approx(before[i].alpha_rad).margin(1e-9));
      CHECK(rows[i].beta_rad == Approx(before[i].beta_rad).margin(1e-9));
      if (i > 0) CHECK(rows[i].a_mm == Approx(before[i].a_mm).margin(1e-6));
    }
    before = rows;
  }
}

TEST_CASE("axes that hang on no height are seen from the base as they were", "[height]") {
  const auto given =
      axes_before_a_device(accuracy::robot_of({identify::test::kr5_arc(), {}, {{200, 0, 215}}}), 1);
  const std::vector<std::optional<Axis>> z(given.begin(), given.end());
  const auto seen = seen_from_base(z, 1000, {});
  for (std::size_t j = 0; j < z.size(); ++j) CHECK(seen[j]->point_mm == z[j]->point_mm);
}
