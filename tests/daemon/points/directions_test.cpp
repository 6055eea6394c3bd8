// Which way joints turn, where no angles tell: points that name their joint, of arms as they are
// built, measured by a device whose frame is its own, moved as people move them.

#include <algorithm>
#include <cmath>
#include <random>

#include "daemon/points/declared_directions.hpp"
#include "daemon/points/point_sweeps.hpp"
#include "daemon/settings/robot_description.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/simulation/simulation.hpp"

using namespace sweepd;
using namespace sweepd::test;
using identify::Status;

namespace {

enum class Moved { one_way, reversed, there_and_back, repeated, reordered };

/// A description's robot as one of its kind is built, somewhere in a device's frame.
simulation::Robot robot_of(const RobotDescription& description, std::uint32_t seed) {
  simulation::Robot robot;
  robot.specified = robot.arm = *description.arm;
  robot.targets_mm = {{150, 60, 120}};
  return simulation::built(robot, seed);
}

/// Positions alone, one list with the joint's number.
PointsFile points_of(const simulation::Robot& robot, Moved moved, std::uint32_t seed) {
  simulation::Strokes strokes;
  strokes.samples = 60;
  strokes.there_and_back = moved == Moved::there_and_back;
  strokes.repeats = moved == Moved::repeated ? 2 : 1;
  simulation::World world;
  world.placed = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  auto sweeps = simulation::Simulation(robot, strokes, world, seed).sweeps();
  std::mt19937 random(seed);
  if (moved == Moved::reordered)
    std::stable_sort(sweeps.begin(), sweeps.end(), [](const auto& a, const auto& b) {
      return *a.joint * 5 % 7 < *b.joint * 5 % 7;
    });
  PointsFile file;
  file.with_joints = true;
  std::size_t number = 0;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    auto samples = *sweeps[s].samples;
    if (moved == Moved::reversed && random() % 2 == 0) std::reverse(samples.begin(), samples.end());
    // There and back is one sweep to who wrote the file.
    const bool goes_on =
        moved == Moved::there_and_back && s > 0 && sweeps[s].joint == sweeps[s - 1].joint;
    if (!goes_on) ++number;
    for (auto& sample : samples) {
      sample.time_s = static_cast<double>(file.points.size());
      file.points.push_back({sample, *sweeps[s].joint + 1, number, 0});
    }
  }
  return file;
}

identify::Identification identified(const PointsFile& file, const RobotDescription& description) {
  identify::Campaign campaign;
  campaign.joints = description.joints();
  campaign.specified = description.arm;
  campaign.device_frame = true;
  return identify::identify(listed_sweeps(file, campaign.resolution), campaign);
}

/// Whether a number of the table has the other sign or worse, but for row 1's b and theta, which
/// are the device's.
bool wrong(const identify::Identification& found, const simulation::Robot& robot) {
  const auto differs = [](const identify::DhNumber& number, double truth, double by) {
    return number.knowledge == identify::Knowledge::identified &&
           std::abs(number.value - truth) > by;
  };
  for (std::size_t j = 0; j + 1 < robot.arm.rows.size(); ++j) {
    const auto& row = found.dh[j];
    const auto& truth = robot.arm.rows[j];
    if (j > 0 && differs(row.b_mm, truth.b_mm, 5)) return true;
    if (differs(row.a_mm, truth.a_mm, 5)) return true;
    if (row.alpha_rad.knowledge == identify::Knowledge::identified &&
        std::abs(identify::wrapped(row.alpha_rad.value - truth.alpha_rad)) > radians(1))
      return true;
    if (j > 0 && row.theta_rad.knowledge == identify::Knowledge::identified &&
        std::abs(identify::wrapped(row.theta_rad.value - truth.theta_rad)) > radians(3))
      return true;
  }
  return false;
}

}  // namespace

TEST_CASE("No way of moving the joints makes a wrong robot of five that stand at home",
          "[directions][long]") {
  const auto moved = GENERATE(Moved::one_way, Moved::reversed, Moved::there_and_back,
                              Moved::repeated, Moved::reordered);
  const std::string name =
      GENERATE("kr5_arc", "kr6_r900_sixx", "kr10_r1420", "kr16_2", "kr150_r3100_2");
  CAPTURE(name, static_cast<int>(moved));
  const auto description = load_robot(kConfig / "robots" / (name + ".toml"));
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const auto robot = robot_of(description, seed);
    const auto found = identified(points_of(robot, moved, seed), description);
    const bool ambiguous =
        std::any_of(found.warnings.begin(), found.warnings.end(),
                    [](const auto& warning) { return warning.code == "direction_ambiguous"; });
    CHECK_FALSE(ambiguous);
    CHECK_FALSE(wrong(found, robot));
    CHECK(found.status == Status::complete);
  }
}

TEST_CASE("Away from home what only the pose tells is ambiguous, never complete, and never wrong",
          "[directions][long]") {
  const std::string name = GENERATE("kr5_arc", "kr16_2");
  CAPTURE(name);
  const auto description = load_robot(kConfig / "robots" / (name + ".toml"));
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const auto robot = simulation::at_random_home(robot_of(description, seed), seed);
    const auto found = identified(points_of(robot, Moved::reversed, seed), description);
    CHECK_FALSE(wrong(found, robot));
    if (found.status != Status::complete)
      CHECK(std::any_of(found.warnings.begin(), found.warnings.end(),
                        [](const auto& warning) { return warning.code == "direction_ambiguous"; }));
  }
}

TEST_CASE("A plan's sweeps given twice, and those with their ways, tell the same senses",
          "[directions]") {
  const auto description = load_robot(kConfig / "robots/kr5_arc.toml");
  SweepPlan plan;
  plan.home_deg.assign(6, 0);
  std::vector<identify::DeclaredJoint> order;
  for (std::size_t joint = 1; joint <= 6; ++joint) {
    // As the simulation moves them: 45 degrees to both sides of home.
    const double sense = joint % 2 == 1 ? 1 : -1;
    PlannedSweep sweep;
    sweep.joint = joint;
    sweep.start_deg = -45 * sense;
    sweep.end_deg = 45 * sense;
    plan.sweeps.push_back(sweep);
    order.push_back({joint - 1,
                     sense > 0 ? -1 : 1,
                     {radians(-45 * sense), radians(90 * sense), radians(-45 * sense)}});
  }
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto robot = robot_of(description, seed);
    const auto moved = seed % 2 == 0 ? Moved::one_way : Moved::repeated;
    auto sweeps = listed_sweeps(points_of(robot, moved, seed), {});
    declare_directions(sweeps, plan, order);
    for (std::size_t s = 0; s < sweeps.size(); ++s) {
      CAPTURE(seed, s);
      CHECK(sweeps[s].direction == (*sweeps[s].joint % 2 == 0 ? 1 : -1));
    }
  }
}
