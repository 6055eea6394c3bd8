// The tool's orientation in the chain: what it adds, and when it is left alone.

#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"
#include "tests/simulation/simulation.hpp"
#include "tests/simulation/truth.hpp"

using namespace identify;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using identify::test::for_kr5;
using identify::test::kPrinted;
using identify::test::printed;

namespace {

/// A, B, C of R = Rz(a) Ry(b) Rx(c), in degrees.
Vector3d abc_deg(const Matrix3d& r) {
  return Vector3d(std::atan2(r(1, 0), r(0, 0)), std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))),
                  std::atan2(r(2, 1), r(2, 2))) /
         kDegree;
}

/// As a controller prints them; the tool's frame is turned by `tool` against the last one.
std::vector<Sample> as_printed(const test::Campaign& campaign, const Matrix3d& tool) {
  std::vector<Sample> samples = campaign.samples();
  for (Sample& sample : samples) {
    const std::vector<double> angles(sample.angles_rad.begin(), sample.angles_rad.begin() + 6);
    const Vector3d abc = abc_deg(forward_kinematics(campaign.arm(), angles).linear() * tool);
    for (std::size_t k = 0; k < 3; ++k)
      sample.abc_rad[k] = printed(abc(static_cast<Eigen::Index>(k))) * kDegree;
    sample.has_orientation = true;
    for (std::size_t k = 0; k < 6; ++k)
      sample.angles_rad[k] = printed(sample.angles_rad[k] / kDegree) * kDegree;
    for (Eigen::Index k = 0; k < 3; ++k) sample.position_mm(k) = printed(sample.position_mm(k));
  }
  return samples;
}

const Matrix3d kTool =
    (Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.5, Vector3d::UnitY()))
        .toRotationMatrix();

}  // namespace

TEST_CASE("the controller's orientations make the last row and the tool known", "[orientation]") {
  test::Campaign campaign(test::kr5_arc(), {0.0005, 0, 4});
  campaign.sweep_all_30();
  const auto sweeps = test::segment(as_printed(campaign, kTool), for_kr5(kPrinted).resolution);
  const auto with = identify::identify(sweeps, for_kr5(kPrinted));
  REQUIRE(with.chain);
  CHECK(with.status == Status::complete);
  CHECK(with.chain->with_orientation);
  REQUIRE(with.tool);
  CHECK((with.tool->translation() - test::kr5_arc().tool_mm).norm() < 0.02);
  CHECK((with.tool->linear() - kTool).norm() < 1e-5);
  REQUIRE(with.row_to_tool);
  CHECK(with.dh[5].a_mm.knowledge == Knowledge::by_convention);
  // Row 6 leads to the line through the tool point along the tool's Z.
  const Vector3d z = kTool.col(2);
  const Axis last{{0, 0, 1}, {0, 0, 0}};
  const Axis tool{z, test::kr5_arc().tool_mm};
  const auto expected = extract_dh({last, tool}, 2000);
  const DhEstimate& row = *with.row_to_tool;
  CHECK(row.a_mm.knowledge == Knowledge::identified);
  CHECK(row.a_mm.sigma < 0.01);
  CHECK(std::abs(std::abs(row.a_mm.value) - std::abs(expected[0].a_mm.value)) < 5 * row.a_mm.sigma);
  CHECK(std::abs(std::abs(row.alpha_rad.value) - std::abs(expected[0].alpha_rad.value)) <
        5 * row.alpha_rad.sigma);
  // The axes gain too: their directions are seen directly.
  auto positions_only = sweeps;
  for (Sweep& sweep : positions_only) {
    auto samples = *sweep.samples;
    for (Sample& sample : samples) sample.has_orientation = false;
    sweep.samples = std::make_shared<const std::vector<Sample>>(samples);
  }
  const auto without = identify::identify(positions_only, for_kr5(kPrinted));
  CHECK_FALSE(without.row_to_tool);
  for (std::size_t i = 0; i + 1 < 6; ++i) {
    CHECK(with.dh[i].alpha_rad.sigma < without.dh[i].alpha_rad.sigma);
    CHECK(std::abs(with.dh[i].alpha_rad.value - without.dh[i].alpha_rad.value) <
          5 * without.dh[i].alpha_rad.sigma);
  }
}

TEST_CASE("orientations that disagree with the positions are left alone", "[orientation]") {
  test::Campaign campaign(test::kr5_arc(), {0.0005, 0, 4});
  campaign.sweep_all_30();
  auto samples = as_printed(campaign, kTool);
  // The tool was changed half way.
  for (std::size_t i = samples.size() / 2; i < samples.size(); ++i) samples[i].abc_rad[0] += 0.001;
  const auto found =
      identify::identify(test::segment(samples, for_kr5(kPrinted).resolution), for_kr5(kPrinted));
  REQUIRE(found.chain);
  CHECK_FALSE(found.chain->with_orientation);
  CHECK_FALSE(found.row_to_tool);
  CHECK(found.chain->angles[0].trust == AngleTrust::trusted);
}

TEST_CASE("in a device's frame the robot's own place is part of the result",
          "[orientation][long]") {
  test::Campaign campaign(test::kr5_arc(), {0, 0.02, 5});
  campaign.sweep_all_90();
  Eigen::Isometry3d device = Eigen::Isometry3d::Identity();
  device.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).matrix();
  device.translation() = Vector3d(2500, -900, 400);
  auto samples = test::without_angles(campaign.samples());
  for (Sample& sample : samples) sample.position_mm = device * sample.position_mm;
  auto known = for_kr5(kPrinted);
  known.resolution = {};
  known.device_frame = true;
  known.declared_home_rad = test::kr5_arc().home_rad;
  for (std::size_t j = 0; j < 6; ++j) known.order.push_back({j, j == 1 || j == 2 ? 1 : 0});
  for (const auto& [joint, direction] : {std::pair{0, -1}, {1, 1}, {2, 1}, {3, 1}, {4, -1}, {5, 1}})
    known.order[static_cast<std::size_t>(joint)].first_direction = direction;
  const auto found = identify::identify(test::segment(samples, {}), known);
  CHECK(found.status == Status::complete);
  REQUIRE(found.robot_pose);
  for (Eigen::Index k = 0; k < 3; ++k) {
    CHECK(found.robot_pose->position_sigma_mm(k) < 0.1);
    CHECK(std::abs(found.robot_pose->pose.translation()(k) - device.translation()(k)) <
          5 * found.robot_pose->position_sigma_mm(k));
  }
  const Eigen::AngleAxisd off(
      Matrix3d(found.robot_pose->pose.linear().transpose() * device.linear()));
  CHECK(std::abs(off.angle()) < 5 * found.robot_pose->rotation_sigma_rad.norm());
  CHECK(found.dh[0].b_mm.knowledge == Knowledge::by_convention);
  CHECK(found.dh[0].b_mm.value == 400);
  CHECK(found.dh[0].theta_rad.knowledge == Knowledge::by_convention);
  CHECK(found.dh[1].a_mm.knowledge == Knowledge::identified);
}

TEST_CASE("what rounding takes away and no sample shows is in the uncertainties",
          "[orientation][long]") {
  struct Printed {
    int decimals;
    double wobble_deg, arc_deg;
    int samples;
    double ramp;
    bool drawn = false;  ///< from the home as drawn, where axes lie along the frame's
    bool back = false;   ///< over the same places, to the last digit
  };
  const auto how = GENERATE(
      // From sample to sample one step more, nearly.
      Printed{1, 0, 30, 300, 0},
      // All speeds; some of A, B and C hardly change.
      Printed{1, 0, 90, 900, 0.1},
      // Locked joints that wobble about the edge between two steps.
      Printed{2, 0.0005, 90, 900, 0},
      // Coordinates along axes that pass few steps.
      Printed{1, 0, 90, 300, 0, true}, Printed{1, 0.0005, 90, 300, 0, true},
      Printed{2, 0, 90, 300, 0, true}, Printed{2, 0.0005, 90, 300, 0, true, true},
      Printed{3, 0, 90, 300, 0, true}, Printed{3, 0, 90, 300, 0, true, true});
  CAPTURE(how.decimals, how.wobble_deg, how.arc_deg, how.drawn, how.back);
  simulation::World world;
  world.controller = world.orientations = world.angles = true;
  world.decimals = how.decimals;
  world.wobble_deg = how.wobble_deg;
  simulation::Strokes strokes;
  strokes.arc_deg = how.arc_deg;
  strokes.samples = how.samples;
  strokes.ramp = how.ramp;
  strokes.there_and_back = how.back;
  double squares = 0;
  int numbers = 0, inside = 0;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const auto robot = simulation::built(simulation::kr5(), seed);
    const simulation::Simulation arm(how.drawn ? robot : simulation::at_random_home(robot, seed),
                                     strokes, world, seed);
    const auto found = identify::identify(arm.sweeps(), arm.campaign());
    REQUIRE(found.chain);
    CHECK(found.chain->with_orientation);
    for (const double z : simulation::errors_in_sigmas(arm, found)) {
      squares += z * z;
      inside += std::abs(z) < 1.96;
      ++numbers;
    }
  }
  CHECK(numbers > 70);
  CHECK(std::sqrt(squares / numbers) < 1.15);
  CHECK(inside >= 0.93 * numbers);
}

TEST_CASE("a tool point within a millimetre of axis 6 makes no number more certain than it is",
          "[orientation]") {
  const auto radius_mm = GENERATE(0.3, 0.7, 0.95, 1.05);
  const auto seed = GENERATE(1U, 2U, 3U, 4U);
  CAPTURE(radius_mm, seed);
  auto robot = simulation::kr5();
  robot.targets_mm = {
      Vector3d(radius_mm * std::cos(seed), radius_mm * std::sin(seed), 215)};  // any side of it
  simulation::World world;
  world.controller = world.angles = world.orientations = true;
  world.decimals = 2;
  const simulation::Simulation simulation(robot, {}, world, seed);
  const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
  if (found.status != Status::complete) return;
  for (const double z : simulation::errors_in_sigmas(simulation, found)) CHECK(std::abs(z) < 6);
}
