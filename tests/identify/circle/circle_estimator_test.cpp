#include "identify/circle/circle_estimator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/linear_robots.hpp"
#include "tests/identify/simulated_campaign.hpp"
#include "tests/simulation/simulation.hpp"

using namespace identify;
using identify::test::find_warning;
using identify::test::for_kr5;
using identify::test::segment;
using identify::test::without_angles;

namespace {

/// Bounds in mm and degrees; b by convention is not compared.
void check_table(const CircleEstimate& result, double b, double a, double alpha_deg) {
  REQUIRE(result.circle_dh.size() == 6);
  for (std::size_t i = 0; i < 5; ++i) {
    CAPTURE(i);
    const auto& row = result.circle_dh[i];
    const auto& wanted = result.specified[i];
    if (row.b_mm.knowledge == Knowledge::identified)
      CHECK(std::abs(row.b_mm.value - wanted.b_mm) < b);
    CHECK(std::abs(row.a_mm.value - wanted.a_mm) < a);
    CHECK(std::abs(wrapped(row.alpha_rad.value - wanted.alpha_rad)) / kDegree < alpha_deg);
    CHECK(std::abs(wrapped(row.theta_rad.value - wanted.theta_rad)) / kDegree < 2 * alpha_deg);
  }
}

std::size_t axes_of(const CircleEstimate& result) {
  return static_cast<std::size_t>(
      std::count_if(result.joints.begin(), result.joints.end(),
                    [](const JointResult& joint) { return joint.axis.has_value(); }));
}

}  // namespace

TEST_CASE("the paper's campaign without noise gives the specified table", "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  const auto result = estimate_circles(segment(campaign.samples()), for_kr5());
  CHECK(axes_of(result) == 6);
  CHECK(result.warnings.empty());
  check_table(result, 1e-6, 1e-6, 1e-7);
  CHECK(result.circle_dh[1].b_mm.knowledge == Knowledge::by_convention);
  for (std::size_t j = 0; j < 6; ++j)
    CHECK(*result.home_rad[j] == Approx(test::kr5_arc().home_rad[j]));
  REQUIRE(result.bounding_box);
}

TEST_CASE("a sample that is metres off is in no box", "[circle_estimator]") {
  const auto boxes = [](test::Campaign campaign, std::size_t of_joint) {
    auto sweeps = segment(campaign.samples(), {}, campaign.arm().joints());
    const auto clean = estimate_circles(sweeps, test::for_arm(campaign.arm()));
    const auto stray =
        estimate_circles(test::changed(std::move(sweeps),
                                       [&](Sweep& sweep, std::vector<identify::Sample>& samples) {
                                         if (sweep.joint == of_joint)
                                           samples[samples.size() / 2].position_mm.y() += 5000;
                                       }),
                         test::for_arm(campaign.arm()));
    REQUIRE(clean.joints[of_joint].box);
    REQUIRE(stray.joints[of_joint].box);
    CHECK_THAT(stray.joints[of_joint].box->lengths_mm.x(),
               Catch::Matchers::WithinRel(clean.joints[of_joint].box->lengths_mm.x(), 0.01));
    CHECK_THAT(stray.bounding_box->volume_mm3(),
               Catch::Matchers::WithinRel(clean.bounding_box->volume_mm3(), 0.01));
  };
  test::Campaign turning(test::kr5_arc(), {0, 0.02, 1});
  boxes(turning.sweep_all_90(), 0);
  test::Campaign sliding(test::scara(), {0, 0.02, 1});
  sliding.rest().sweep(0, -25, 65).sweep(1, 15, 105).sweep(2, 20, 180).sweep(3, -75, 15);
  boxes(sliding, 2);
}

TEST_CASE("only the sweeps proper are fitted: moves from and to home are marked",
          "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  const auto result = estimate_circles(segment(campaign.samples()), for_kr5());
  const auto& first = result.joints[0];
  REQUIRE(first.sweeps.size() == 3);
  CHECK(first.sweeps[0].positioning);
  CHECK_FALSE(first.sweeps[1].positioning);
  CHECK(first.sweeps[2].positioning);
  CHECK(first.used == std::vector<bool>{false, true, false});
  CHECK(first.circle->arc_rad == Approx(90 * kDegree).margin(0.5 * kDegree));
  // Joint 6 starts from home: both its strokes are sweeps.
  CHECK(result.joints[5].used == std::vector<bool>{true, true});
}

TEST_CASE("Strokes that begin at home are sweeps, though their joints have others at a second home",
          "[circle_estimator]") {
  simulation::World world;
  world.angles = GENERATE(true, false);
  simulation::Strokes how;
  how.homes = 2;
  const std::array<double, 2> about = {-45, 45}, from = {0, 90}, to = {90, 0};
  how.ranges_deg = {about, about, about, from, from, to, about, about, about, about, about, about};
  const simulation::Simulation campaign(simulation::kr5(), how, world, 1);
  const auto result = estimate_circles(campaign.sweeps(), campaign.campaign());
  for (const JointResult& joint : result.joints)
    for (const Sweep& sweep : joint.sweeps) CHECK_FALSE(sweep.positioning);
  CHECK(std::none_of(result.warnings.begin(), result.warnings.end(),
                     [](const Warning& warning) { return warning.code == "off_home"; }));
}

TEST_CASE("axes point along positive rotation of the controller's angles", "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  const auto result = estimate_circles(segment(campaign.samples()), for_kr5());
  CHECK((result.joints[0].axis->direction - Eigen::Vector3d(0, 0, -1)).norm() < 1e-7);
  // At A1 = 90 the base's +Y, about which A2 turns at A1 = 0, points along -(-X) of the base.
  CHECK(std::abs(result.joints[1].axis->direction.x()) == Approx(1));
}

TEST_CASE("the circles' uncertainties are those of samples whose errors are correlated",
          "[circle_estimator][long]") {
  const double memory = GENERATE(0.0, 0.7);
  CAPTURE(memory);
  constexpr int kRuns = 20;
  int inside = 0, all = 0;
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  for (std::uint32_t run = 1; run <= kRuns; ++run) {
    std::mt19937 random(run);
    std::normal_distribution<> normal;
    auto samples = campaign.samples();
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    for (Sample& sample : samples) {
      for (Eigen::Index k = 0; k < 3; ++k)
        error(k) = memory * error(k) + 0.02 * std::sqrt(1 - memory * memory) * normal(random);
      sample.position_mm += error;
    }
    const auto result = estimate_circles(segment(samples), for_kr5());
    for (std::size_t i = 0; i < 5; ++i)
      for (const auto& [number, wanted] :
           {std::pair(result.circle_dh[i].a_mm, result.specified[i].a_mm),
            std::pair(result.circle_dh[i].alpha_rad, result.specified[i].alpha_rad)}) {
        if (number.knowledge != Knowledge::identified) continue;
        ++all;
        inside += std::abs(number.value - wanted) < 1.96 * number.sigma ? 1 : 0;
      }
  }
  // Of 200 numbers, which are related, 95 % and three times 2 %. As if they were independent: 60 %.
  REQUIRE(all == 10 * kRuns);
  CHECK(inside >= 0.89 * all);
}

TEST_CASE("without angles the plan's order alone identifies the same robot", "[circle_estimator]") {
  for (const bool wide : {true, false}) {
    test::Campaign campaign(test::kr5_arc(), {0.0001});
    wide ? campaign.sweep_all_90() : campaign.sweep_all_30();
    auto known = for_kr5();
    known.order = {{0, -1}, {1, +1}, {2, +1}, {3, +1}, {4, -1}, {5, +1}};
    known.declared_home_rad = test::kr5_arc().home_rad;
    const auto result = estimate_circles(segment(without_angles(campaign.samples())), known);
    CHECK(axes_of(result) == 6);
    CHECK(result.warnings.empty());
    // Wobble of 0.0001 deg moves the target by some 3 um; see the paper's columns for the bounds.
    wide ? check_table(result, 0.042, 0.009, 0.001) : check_table(result, 0.081, 0.096, 0.01);
  }
}

TEST_CASE("without angles and plan the axes point as agrees with the specified table",
          "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc(), {0.0001});
  campaign.sweep_all_90();
  const auto result = estimate_circles(segment(without_angles(campaign.samples())), for_kr5());
  CHECK(axes_of(result) == 6);
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(std::abs(result.circle_dh[i].a_mm.value - result.specified[i].a_mm) < 0.009);
    CHECK(std::abs(wrapped(result.circle_dh[i].alpha_rad.value - result.specified[i].alpha_rad)) <
          0.001 * kDegree);
    if (result.circle_dh[i].b_mm.knowledge == Knowledge::identified)
      CHECK(std::abs(result.circle_dh[i].b_mm.value - result.specified[i].b_mm) < 0.042);
  }
}

TEST_CASE("a robot without a specified table has axes along positive rotation",
          "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  const auto result = estimate_circles(segment(campaign.samples()), Campaign{});
  CHECK(axes_of(result) == 6);
  CHECK(result.specified.empty());
  // All axes flipped against the paper's table: the same twists, offsets with the other sign.
  CHECK(result.circle_dh[0].b_mm.value == Approx(-400).margin(1e-6));
  CHECK(result.circle_dh[0].a_mm.value == Approx(180).margin(1e-6));
  CHECK(std::abs(result.circle_dh[3].b_mm.value) == Approx(620).margin(1e-6));
}

TEST_CASE("a joint that was never swept makes the result partial and makes up no number",
          "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest()
      .sweep(0, -45, 45)
      .sweep(1, -60, -130)
      .sweep(2, 120, 30)
      .sweep(3, 90, 0)
      .sweep(4, 90, 0);
  const auto result = identify::identify(segment(campaign.samples()), for_kr5());
  CHECK(result.status == Status::partial);
  CHECK(result.reason == "no axis for joint 6");
  REQUIRE(find_warning(result, "joint_never_moved"));
  CHECK(find_warning(result, "joint_never_moved")->joint == 5u);
  CHECK(result.dh[4].alpha_rad.knowledge == Knowledge::undetermined);
  CHECK(result.dh[3].alpha_rad.knowledge == Knowledge::identified);
}

TEST_CASE("a sweep that is too short, or too quick for its samples, is said and not used",
          "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest()
      .move(0, 93)
      .rest()
      .move(0, 90)
      .rest()
      .move(1, -60, 400)
      .rest()
      .move(1, -90, 400)
      .rest();
  const auto result = identify::identify(segment(campaign.samples()), for_kr5());
  CHECK(result.status == Status::failed);
  CHECK(find_warning(result, "sweep_too_short")->joint == 0u);
  CHECK(find_warning(result, "too_few_samples")->joint == 1u);
}

TEST_CASE("strokes that are short because radians were taken for degrees are told from short ones",
          "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest().sweep(0, -45, 45).move(1, -87).rest().move(1, -90).rest();
  auto samples = campaign.samples();
  for (Sample& sample : samples) sample.angles_rad[0] *= kDegree;
  const auto result = identify::identify(segment(samples), for_kr5());
  CHECK(result.status == Status::failed);
  REQUIRE(find_warning(result, "angles_in_radians"));
  CHECK(find_warning(result, "angles_in_radians")->joint == 0u);
  REQUIRE(find_warning(result, "sweep_too_short"));
  CHECK(find_warning(result, "sweep_too_short")->joint == 1u);
}

TEST_CASE(
    "strokes that are short because another joint's angles were given are told from short ones",
    "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  auto sweeps = segment(campaign.samples());
  for (Sweep& sweep : sweeps) {
    auto samples = *sweep.samples;
    for (Sample& sample : samples) std::swap(sample.angles_rad[1], sample.angles_rad[2]);
    sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
    if (sweep.joint != 1U && sweep.joint != 2U) continue;
    sweep.range_rad = 0;
    sweep.defect = SweepDefect::too_short;
  }
  const auto result = identify::identify(sweeps, for_kr5());
  CHECK(result.status == Status::partial);
  const Warning* warning = find_warning(result, "joints_exchanged");
  REQUIRE(warning != nullptr);
  CHECK(warning->joint == 1U);
  CHECK(warning->message.find("the angle of joint 3 turns by") != std::string::npos);
  CHECK(find_warning(result, "sweep_too_short") == nullptr);
}

TEST_CASE("a target on an axis is said and gives no axis", "[circle_estimator]") {
  auto arm = test::kr5_arc();
  arm.tool_mm = {0, 0, 215};
  test::Campaign campaign(arm, {0.0001});
  campaign.sweep_all_90();
  const auto result = identify::identify(segment(campaign.samples()), for_kr5());
  CHECK(result.status == Status::partial);
  CHECK_FALSE(result.joints[5].axis);
  CHECK(result.joints[4].axis);
  REQUIRE(result.warnings.size() == 1);
  CHECK(result.warnings[0].joint == 5u);
}

TEST_CASE("a target near an axis is warned about", "[circle_estimator][long]") {
  auto arm = test::kr5_arc();
  arm.tool_mm = {1.7, 0, 215};
  test::Campaign campaign(arm, {0.0001});
  campaign.sweep_all_90();
  const auto result = identify::identify(segment(campaign.samples()), for_kr5());
  REQUIRE(find_warning(result, "target_near_axis"));
  CHECK(find_warning(result, "target_near_axis")->joint == 5u);
  // The prediction covers the error that it warns of.
  const auto& alpha = result.dh[4].alpha_rad;
  CHECK(std::abs(wrapped(alpha.value - 90 * kDegree)) < 4 * alpha.sigma);
}

TEST_CASE("sweeps away from the common home are left out and said", "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  campaign.move(1, -70).rest().move(0, 10).rest().move(0, 90).rest().move(1, -90).rest();
  auto result = estimate_circles(segment(campaign.samples()), for_kr5());
  CHECK(axes_of(result) == 6);
  check_table(result, 1e-6, 1e-6, 1e-7);
  CHECK(result.joints[0].used == std::vector<bool>{false, true, false, false, false});
}

TEST_CASE("strokes without positions are counted, and the reason is given", "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest().move(0, 0).rest().move(0, 90).rest();
  auto samples = campaign.samples();
  for (auto& sample : samples) sample.has_position = false;
  const auto result = identify::identify(segment(samples), for_kr5());
  CHECK(result.status == Status::partial);
  CHECK(result.reason.find("no positions") != std::string::npos);
  CHECK(result.joints[0].sweeps.size() == 2);
  CHECK_FALSE(result.bounding_box);
}

TEST_CASE("no sweeps at all fail with a reason", "[circle_estimator]") {
  const auto result = identify::identify({}, for_kr5());
  CHECK(result.status == Status::failed);
  CHECK(result.reason == "no sweep of a single joint was seen");
}

TEST_CASE("coarsely printed positions are warned about", "[circle_estimator][long]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  auto known = for_kr5();
  known.resolution = {0.1, 0.1 * kDegree};
  CHECK(find_warning(identify::identify(segment(campaign.samples()), known), "low_precision"));
}

TEST_CASE("positions that contradict the angles give no axis", "[circle_estimator]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_90();
  auto samples = campaign.samples();
  std::mt19937 random(1);
  std::uniform_real_distribution<> uniform(-1000, 1000);
  for (auto& sample : samples)
    sample.position_mm = {uniform(random), uniform(random), uniform(random)};
  const auto result = identify::identify(segment(samples), for_kr5());
  CHECK(result.status != Status::complete);
  CHECK_FALSE(result.warnings.empty());
}

TEST_CASE("where joints never come home to the same place, the nearest sweeps serve",
          "[circle_estimator][long]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<> off(-0.15, 0.15);
  test::Campaign campaign(test::kr5_arc(), {0.0005, 0.02, 6});
  constexpr double kStarts[][2] = {{-45, 45}, {-60, -130}, {120, 30}, {90, 0}, {90, 0}, {0, 90}};
  for (int round = 0; round < 3; ++round)
    for (std::size_t j = 0; j < 6; ++j) {
      for (std::size_t k = 0; k < 6; ++k)
        if (k != j) campaign.move(k, test::kr5_arc().home_rad[k] / kDegree + off(random), 60);
      campaign.move(j, kStarts[j][0], 60).rest().move(j, kStarts[j][1]).rest();
      campaign.move(j, test::kr5_arc().home_rad[j] / kDegree, 60).rest();
    }
  const auto found = identify::identify(segment(campaign.samples()), for_kr5());
  CHECK(found.status == Status::complete);
  CHECK(found.estimator == Estimator::chain);
  const Warning* warning = find_warning(found, "off_home");
  REQUIRE(warning);
  CHECK_THAT(warning->message, Catch::Matchers::ContainsSubstring("° or more"));
  for (std::size_t i = 0; i < 5; ++i) {
    CAPTURE(i);
    const auto covers = [](const DhNumber& number, double truth, double half_turn) {
      if (number.knowledge != Knowledge::identified) return true;
      const double error = half_turn > 0 ? std::remainder(number.value - truth, 2 * half_turn)
                                         : number.value - truth;
      return std::abs(error) < 4 * number.sigma;
    };
    for (const DhEstimate& row : {found.dh[i], found.circle_dh[i]}) {
      CHECK(covers(row.b_mm, found.specified[i].b_mm, 0));
      CHECK(covers(row.a_mm, found.specified[i].a_mm, 0));
      CHECK(covers(row.theta_rad, found.specified[i].theta_rad, kPi));
      CHECK(covers(row.alpha_rad, found.specified[i].alpha_rad, kPi));
    }
    CHECK(found.dh[i].a_mm.sigma < 0.05);
  }
}

TEST_CASE("home is one of several, not made of parts of them", "[circle_estimator][long]") {
  const auto seed = GENERATE(1U, 2U, 3U, 4U, 5U, 6U);
  CAPTURE(seed);
  simulation::World world;
  world.angles = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  world.home.stray_sigma_deg = 0.05;  // each joint comes back elsewhere than it was
  simulation::Strokes strokes;
  strokes.homes = 2;
  strokes.there_and_back = true;
  const auto robot = simulation::at_random_home(simulation::built(simulation::kr5(), seed), seed);
  const simulation::Simulation simulation(robot, strokes, world, seed);
  const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
  CHECK(found.status == Status::complete);
  CHECK(found.estimator == Estimator::chain);
}

TEST_CASE("a joint has the circle of a target that tells its axis", "[circle_estimator]") {
  // The first marker is 30 mm off axis 6, where 0.3 mm of noise leaves the axis open.
  simulation::World world;
  world.placed = world.angles = true;
  world.noise.range_mm = world.noise.across_mm = 0.3;
  simulation::Strokes strokes;
  strokes.arc_deg = 40;
  strokes.samples = 200;
  strokes.targets_at_once = true;
  simulation::Robot robot = simulation::built(simulation::kr5(3), 1);
  robot.targets_mm = {{30, 0, 160}, {200, 30, 215}, {-120, 90, 260}};
  const simulation::Simulation simulation(robot, strokes, world, 1);
  const auto result = estimate_circles(simulation.sweeps(), simulation.campaign());
  CHECK(axes_of(result) == 6);
  CHECK(result.joints[5].circle_target == 1);
  for (std::size_t j = 0; j < 5; ++j) CHECK(result.joints[j].circle_target == 0);
}
