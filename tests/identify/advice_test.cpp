#include "identify/advice.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "tests/bench/accuracy_campaign.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"
#include "tests/simulation/printed.hpp"

using namespace identify;
using Catch::Matchers::ContainsSubstring;
using identify::test::changed;
using identify::test::find_warning;
using identify::test::kr5_arc;
using identify::test::segment;

namespace {

accuracy::Simulated kr5_swept(double arc_deg = 90) {
  accuracy::Simulated robot;
  robot.arm = kr5_arc();
  robot.targets_mm = {robot.arm.tool_mm};
  robot.samples = 1000;  // 90 degrees in 4 s
  for (const double home : robot.arm.home_rad)
    robot.ranges.push_back({home / kDegree - arc_deg / 2, home / kDegree + arc_deg / 2});
  return robot;
}

const simulation::World kController = accuracy::controller();

Identification identified(const accuracy::Simulated& robot,
                          const simulation::World& world = kController) {
  return identify::identify(sweeps_of(robot, world, 1), campaign_of(robot, world));
}

/// The words of a warning that must be there.
std::string message(const Identification& found, std::string_view code,
                    std::optional<std::size_t> joint) {
  INFO(code);
  for (const Warning& warning : found.warnings)
    if (warning.code == code && warning.joint == joint) return warning.message;
  for (const Warning& warning : found.warnings)
    UNSCOPED_INFO(warning.code + ": " + warning.message);
  FAIL("no such warning");
  return {};
}

}  // namespace

TEST_CASE("a clean campaign of 90 degrees gets no advice", "[advice][long]") {
  const auto found = identified(kr5_swept());
  CHECK(found.estimator == Estimator::chain);
  for (const Warning& warning : found.warnings)
    UNSCOPED_INFO(warning.code + ": " + warning.message);
  CHECK(found.warnings.empty());
}

TEST_CASE("positions in another frame than the robot's own are told by row 1", "[advice][long]") {
  const auto robot = kr5_swept();
  auto campaign = campaign_of(robot, kController);
  REQUIRE(campaign.specified);
  campaign.specified->rows.front().b_mm += 9;
  const auto found = identify::identify(sweeps_of(robot, kController, 1), campaign);
  CHECK_THAT(message(found, "base_elsewhere", 0), ContainsSubstring("b of row 1 is -9.0 mm"));
  campaign.device_frame = true;
  const auto seen = identify::identify(sweeps_of(robot, kController, 1), campaign);
  CHECK(find_warning(seen, "base_elsewhere") == nullptr);
}

TEST_CASE("the paper's campaign, moved as a controller moves, gets none either", "[advice][long]") {
  test::Campaign moved(kr5_arc(), {.wobble_deg = 0.0005});
  moved.sweep_all_90();
  auto samples = moved.samples();
  for (Sample& sample : samples) {
    for (double& value : sample.position_mm) value = simulation::printed(value, 4);
    for (double& value : sample.angles_rad)
      value = simulation::printed(value / kDegree, 4) * kDegree;
  }
  identify::Campaign known;
  known.specified = kr5_arc();
  known.resolution = {1e-4, 1e-4 * kDegree};
  const auto found = identify::identify(segment(samples, known.resolution), known);
  for (const Warning& warning : found.warnings)
    UNSCOPED_INFO(warning.code + ": " + warning.message);
  CHECK(found.warnings.empty());
}

TEST_CASE("a target near an axis is told, and what another point would give", "[advice][long]") {
  auto robot = kr5_swept();
  robot.targets_mm = {{1.7, 0, 215}};
  const auto found = identified(robot);
  CHECK_THAT(message(found, "target_near_axis", 5),
             ContainsSubstring("radius 1.7 mm") && ContainsSubstring("100 mm would give"));
}

/// The sweeps of a device that lost one point of each of these joints' arcs: it is elsewhere.
std::vector<Sweep> with_strays(std::vector<Sweep> sweeps, const std::vector<std::size_t>& joints,
                               const Eigen::Vector3d& off_mm) {
  for (Sweep& sweep : sweeps) {
    if (std::find(joints.begin(), joints.end(), *sweep.joint) == joints.end()) continue;
    auto samples = *sweep.samples;
    samples[samples.size() * 2 / 3].position_mm += off_mm;
    sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  }
  return sweeps;
}

TEST_CASE("a single point far off turns no axis over, be the points few or many",
          "[advice][long]") {
  auto robot = kr5_swept();
  auto world = accuracy::tracker(0.02);
  for (const int samples : {15, 40, 200}) {
    robot.samples = samples;
    const auto known = campaign_of(robot, world);
    for (std::size_t j = 0; j < 6; ++j)
      for (const double off_mm : {-130.0, 60.0}) {
        CAPTURE(samples, j, off_mm);
        const auto found = identify::identify(
            with_strays(sweeps_of(robot, world, 7), {j}, {off_mm, -off_mm / 2, off_mm / 3}), known);
        CHECK(found.status == Status::complete);
        CHECK(found.doubts.empty());
        for (std::size_t i = 0; i < 5; ++i) {
          const auto& row = found.dh[i];
          const auto& wanted = found.specified[i];
          CHECK(std::abs(wrapped(row.alpha_rad.value - wanted.alpha_rad)) < 0.02);
          if (i > 0) CHECK(std::abs(wrapped(row.theta_rad.value - wanted.theta_rad)) < 0.02);
          CHECK(std::abs(row.a_mm.value - wanted.a_mm) < 2);
        }
      }
  }
}

TEST_CASE("a device that loses sight for a sample accuses no gear", "[advice]") {
  auto world = accuracy::tracker(0.02);
  world.angles = world.placed = true;
  world.decimals = 4;
  auto robot = kr5_swept();
  robot.samples = 300;
  const auto found = identify::identify(
      with_strays(sweeps_of(robot, world, 1), {0, 1, 2, 3, 4, 5}, {-2000, 1500, 1000}),
      campaign_of(robot, world));
  REQUIRE(found.status == Status::complete);
  CHECK_FALSE(find_warning(found, "transmission_error"));
  CHECK_FALSE(find_warning(found, "backlash"));
}

TEST_CASE("of seven points an arc none is taken for a stray where all are alike",
          "[advice][long]") {
  auto robot = kr5_swept();
  robot.samples = 7;
  const auto world = accuracy::tracker(0.02);
  std::size_t outliers = 0, inside = 0, all = 0;
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    const auto found = identify::identify(sweeps_of(robot, world, seed), campaign_of(robot, world));
    REQUIRE(found.chain);
    outliers += found.chain->outliers;
    for (std::size_t i = 1; i < 5; ++i)
      for (const auto& [number, truth] : {std::pair(found.dh[i].a_mm, found.specified[i].a_mm),
                                          {found.dh[i].alpha_rad, found.specified[i].alpha_rad}}) {
        if (number.knowledge != Knowledge::identified) continue;
        ++all;
        if (std::abs(number.value - truth) < 1.96 * number.sigma) ++inside;
      }
  }
  // Of 1260 points a third was, and 84 % lay inside.
  CHECK(outliers < 60);
  CHECK(static_cast<double>(inside) > 0.9 * static_cast<double>(all));
}

TEST_CASE("what hangs on how high the device stands is told where the first axes are parallel",
          "[advice][long]") {
  auto robot = kr5_swept();
  auto world = accuracy::tracker(0.02);
  world.placed = true;
  robot.samples = 100;
  auto sweeps = sweeps_of(robot, world, 1);
  const auto whole = identify::identify(sweeps, campaign_of(robot, world));
  CHECK_FALSE(find_warning(whole, "height_unknown"));
  std::erase_if(sweeps, [](const Sweep& sweep) { return *sweep.joint == 0; });
  const auto found = identify::identify(sweeps, campaign_of(robot, world));
  CHECK_THAT(message(found, "height_unknown", 1), ContainsSubstring("for each metre"));
}

TEST_CASE("a short arc is told, and what a longer one would give comes true", "[advice][long]") {
  const auto world = accuracy::tracker(0.05);
  auto robot = kr5_swept();
  robot.ranges[3] = {-8, 8};
  const auto found = identified(robot, world);
  const auto text = message(found, "arc_short", 3);
  CHECK_THAT(text, ContainsSubstring("arc 16.") && ContainsSubstring("sweep it over 32."));
  // The message's prediction, against the same arm swept so far.
  const auto from = text.find("give about ") + 11;
  const double predicted = std::stod(text.substr(from));
  robot.ranges[3] = {-16, 16};
  const auto better = identified(robot, world);
  CHECK(better.joints[3].axis->direction_sigma_rad() / kDegree == Approx(predicted).epsilon(0.3));
}

TEST_CASE("an arc that gives no axis at all is told", "[advice]") {
  const auto coarse = accuracy::tracker(0.15);
  auto robot = kr5_swept();
  robot.ranges[5] = {-4, 4};
  const auto found = identified(robot, coarse);
  CHECK_FALSE(found.joints[5].axis);
  CHECK_THAT(message(found, "arc_short", 5), ContainsSubstring("more than 1°"));
}

TEST_CASE("a joint swept much less than the others is told with the factor", "[advice][long]") {
  auto robot = kr5_swept();
  robot.ranges[4] = {75, 105};
  const auto found = identified(robot);
  CHECK_THAT(message(found, "range_unbalanced", 4),
             ContainsSubstring("times less certain") && ContainsSubstring("over 90.0°"));
  CHECK_FALSE(find_warning(found, "arc_short"));
}

TEST_CASE("a quick target is told with its speed", "[advice]") {
  auto robot = kr5_swept();
  robot.samples = 100;  // 90 degrees in 0.396 s
  CHECK_THAT(message(identified(robot), "speed_high", 5), ContainsSubstring("mm/s, 3.2 mm"));
}

TEST_CASE("coarsely printed numbers are told, in words that fit any device", "[advice]") {
  CHECK_THAT(message(identified(kr5_swept(), accuracy::controller(1)), "low_precision", {}),
             ContainsSubstring("0.1000 mm") && ContainsSubstring("on a KUKA controller"));
}

TEST_CASE("steps are told only of numbers that there are", "[advice][issue11][point_20][long]") {
  auto campaign = campaign_of(kr5_swept(), kController);
  campaign.resolution = {0, 0.1 * kDegree};
  const auto sweeps = sweeps_of(kr5_swept(), kController, 1);
  CHECK_THAT(message(identify::identify(sweeps, campaign), "low_precision", {}),
             ContainsSubstring("in steps of 0.1000°:") && !ContainsSubstring("mm"));
  campaign.resolution = {0.1, 0};
  CHECK_THAT(message(identify::identify(sweeps, campaign), "low_precision", {}),
             ContainsSubstring("in steps of 0.1000 mm:") && !ContainsSubstring("°:"));
}

TEST_CASE("an angle that depends on the direction of the motion is told", "[advice][long]") {
  // Joint 2 there and back; on the way back its angle reads 20 arcsec more.
  constexpr double kBacklash_rad = 20 * kArcsec;
  const auto robot = kr5_swept();
  auto sweeps = sweeps_of(robot, kController, 1);
  auto back = changed({sweeps[1]}, [&](Sweep& sweep, std::vector<Sample>& samples) {
    sweep.direction = -sweep.direction;
    std::reverse(samples.begin(), samples.end());
    double time = 100;
    for (Sample& sample : samples) {
      sample.time_s = time += 0.004;
      sample.angles_rad[1] += kBacklash_rad;
    }
  });
  sweeps.push_back(back.front());
  const auto found = identify::identify(sweeps, campaign_of(robot, kController));
  const auto text = message(found, "backlash", 1);
  CHECK_THAT(text, ContainsSubstring("20 arcsec"));
}

TEST_CASE("a smooth error of a joint's angles is told with its size", "[advice][long]") {
  // 100 arcsec twice a turn: over 90 degrees half a wave, less what offset and centre take up.
  auto uneven = accuracy::tracker(0.005);
  uneven.angles = true;
  uneven.gears.second_arcsec = 100;
  uneven.gears.joint = 1;
  const auto found = identified(kr5_swept(), uneven);
  CHECK_THAT(message(found, "transmission_error", 1), ContainsSubstring("arcsec from lowest"));
  CHECK_FALSE(std::any_of(found.warnings.begin(), found.warnings.end(), [](const Warning& warning) {
    return warning.code == "transmission_error" && warning.joint != 1u;
  }));
}

TEST_CASE("angles that follow no pattern are told to be unused", "[advice][long]") {
  const auto robot = kr5_swept();
  std::mt19937 random(1);
  std::normal_distribution<> normal;
  const auto sweeps =
      changed(sweeps_of(robot, kController, 1), [&](Sweep& sweep, std::vector<Sample>& samples) {
        if (sweep.joint == 2u)
          for (Sample& sample : samples) sample.angles_rad[2] += 0.01 * kDegree * normal(random);
      });
  const auto found = identify::identify(sweeps, campaign_of(robot, kController));
  CHECK_THAT(message(found, "angles_not_used", 2), ContainsSubstring("arcsec rms"));
}

TEST_CASE("noise that is alike from sample to sample is told", "[advice][long]") {
  auto slow = accuracy::tracker(0.02);
  slow.noise.correlation = 0.95;
  CHECK_THAT(message(identified(kr5_swept(), slow), "correlated_noise", {}),
             ContainsSubstring("samples tell as much as one"));
}

TEST_CASE("points far off are told with their share", "[advice]") {
  auto interrupted = accuracy::tracker(0.02);
  interrupted.noise.outlier_share = 0.05;
  CHECK_THAT(message(identified(kr5_swept(), interrupted), "outliers", {}),
             ContainsSubstring(" of 6000 samples ("));
}

TEST_CASE("sweeps that miss each other's home are told", "[advice][long]") {
  const auto world = accuracy::tracker(0.02);
  const auto robot = kr5_swept();
  // The target was knocked before joint 4 swept.
  const auto sweeps =
      changed(sweeps_of(robot, world, 1), [](Sweep& sweep, std::vector<Sample>& samples) {
        if (sweep.joint == 3u)
          for (Sample& sample : samples) sample.position_mm += Eigen::Vector3d(1, 1, 1);
      });
  const auto found = identify::identify(sweeps, campaign_of(robot, world));
  CHECK_THAT(message(found, "home_not_shared", {}), ContainsSubstring("lock the other joints"));
}

TEST_CASE("a device that drifts steadily is told", "[advice][chain_advice]") {
  auto world = accuracy::tracker(0.02);
  for (const Warning& warning : identified(kr5_swept(), world).warnings)
    CHECK(warning.code != "device_drifts");
  world.drift.linear_mm = 0.2;
  CHECK_THAT(message(identified(kr5_swept(), world), "device_drifts", {}),
             ContainsSubstring(" min, the target drifted steadily by 0.2"));
  auto campaign = campaign_of(kr5_swept(), world);
  campaign.timed = false;  // the samples' order is all that is known
  const auto found = identify::identify(sweeps_of(kr5_swept(), world, 1), campaign);
  CHECK_THAT(message(found, "device_drifts", {}),
             ContainsSubstring("to the last one the target drifted steadily by 0.2"));
}

TEST_CASE("a device that sways while each joint is swept once is told", "[advice][chain_advice]") {
  auto world = accuracy::tracker(0.02);
  world.drift.sway_mm = 0.2;
  world.drift.sways = 3;
  CHECK_THAT(message(identified(kr5_swept(), world), "device_drifts", {}),
             ContainsSubstring("Sweep each joint there and back"));
  // Nor are joints that come back elsewhere such a device.
  auto homes = accuracy::tracker(0.02);
  homes.home.sigma_deg = 0.005;
  for (const Warning& warning : identified(kr5_swept(), homes).warnings)
    CHECK(warning.code != "device_drifts");
}

TEST_CASE("orientations agree with positions of a target near the last axis", "[advice][long]") {
  auto still = kController;
  still.orientations = true;
  auto wobbling = still;  // by more than they and positions are printed to
  wobbling.wobble_deg = 1e-4;
  wobbling.decimals = 5;
  for (const auto& [off_mm, world] : {std::pair(0.2, still), std::pair(0.5, still),
                                      std::pair(2.0, still), std::pair(0.5, wobbling)}) {
    auto robot = kr5_swept();
    robot.targets_mm.front() = {off_mm, 0, 150};
    const auto found = identify::identify(sweeps_of(robot, world, 1), campaign_of(robot, world));
    CAPTURE(off_mm, world.wobble_deg);
    REQUIRE(found.chain);
    CHECK(found.chain->with_orientation);
    for (const Warning& warning : found.warnings) CHECK(warning.code != "orientation_inconsistent");
  }
}

TEST_CASE("orientations that contradict the positions are told", "[advice][long]") {
  const auto robot = kr5_swept();
  const auto sweeps =
      changed(sweeps_of(robot, kController, 1), [](Sweep&, std::vector<Sample>& samples) {
        for (Sample& sample : samples) {
          sample.has_orientation = true;
          sample.abc_rad = {0.3, -0.2, 0.1};  // another tool's: it never turns
        }
      });
  const auto found = identify::identify(sweeps, campaign_of(robot, kController));
  CHECK_THAT(message(found, "orientation_inconsistent", {}), ContainsSubstring("A, B, C"));
}
