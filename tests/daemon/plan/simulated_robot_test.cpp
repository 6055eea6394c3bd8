#include "daemon/plan/simulated_robot.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "daemon/settings/toml_table.hpp"
#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using identify::kDegree;
using sweepd::ConfigError;
using sweepd::SimulatedRobot;
using sweepd::SweepPlan;
using namespace std::chrono_literals;
using sweepd::test::kConfig;
namespace fs = std::filesystem;

namespace {

sweepd::RobotDescription kr5() {
  return sweepd::load_robot(kConfig / "robots/kr5_arc.toml");
}

SweepPlan table_2(const char* file = "kr5_arc_90deg.toml") {
  return sweepd::load_plan(kConfig / "plans" / file);
}

/// All cycles of a run.
std::vector<rsi::SignalValues> run(SimulatedRobot robot) {
  std::vector<rsi::SignalValues> cycles;
  for (rsi::SignalValues values; robot.next(values);) cycles.push_back(values);
  return cycles;
}

/// An arm of two joints in a plane, and one sweep of its second joint.
sweepd::RobotDescription planar_arm() {
  sweepd::RobotDescription robot;
  robot.name = "planar";
  robot.home_deg = {0, 0};
  robot.limits.resize(2);
  robot.arm = identify::Arm{.rows = {{.a_mm = 100}, {.a_mm = 50}},
                            .home_rad = {0, 0},
                            .positive = {1, 1},
                            .tool_mm = {0, 0, 5},
                            .linear = {}};
  return robot;
}

SweepPlan planar_plan(double start_deg, double end_deg, double speed_deg_s) {
  SweepPlan plan;
  plan.file = "plan.toml";
  plan.home_deg = {0, 0};
  plan.positioning_speed_deg_s = 20;
  plan.acceleration_deg_s2 = 40;
  plan.dwell = 100ms;
  plan.sweeps = {{2, start_deg, end_deg, speed_deg_s, 7}};
  return plan;
}

SimulatedRobot::Options simulation_options(double wobble_deg = 1e-4, std::uint64_t seed = 1) {
  return {.cycle = 4ms, .wobble_deg = wobble_deg, .seed = seed, .tool_mm = {}};
}

/// One joint's way from rest to rest, as it is seen in the commanded angles.
struct OneWay {
  std::size_t joint;  // from 1
  double from_deg;
  double to_deg;
  double peak_deg_s;
  std::size_t rest_before;  // cycles without any motion
};

std::vector<OneWay> strokes(const std::vector<rsi::SignalValues>& cycles, double cycle_s) {
  std::vector<OneWay> found;
  std::size_t rest = 0;
  for (std::size_t k = 1; k < cycles.size(); ++k) {
    std::size_t moving = 0;
    for (std::size_t j = 0; j < 6; ++j)
      if (cycles[k].ASPos[j] != cycles[k - 1].ASPos[j]) {
        REQUIRE(moving == 0);  // one joint at a time
        moving = j + 1;
      }
    if (moving == 0) {
      ++rest;
      continue;
    }
    const double from_deg = cycles[k - 1].ASPos[moving - 1];
    if (rest > 0) found.push_back({moving, from_deg, from_deg, 0, rest});
    rest = 0;
    REQUIRE(!found.empty());
    REQUIRE(found.back().joint == moving);
    found.back().to_deg = cycles[k].ASPos[moving - 1];
    const double speed_deg_s = std::abs(found.back().to_deg - from_deg) / cycle_s;
    found.back().peak_deg_s = std::max(found.back().peak_deg_s, speed_deg_s);
  }
  return found;
}

}  // namespace

TEST_CASE("the sets of Table 2 are played from home to home, each sweep from start to end",
          "[simulated_robot]") {
  const auto* file = GENERATE("kr5_arc_90deg.toml", "kr5_arc_30deg.toml");
  const auto plan = table_2(file);
  const auto cycles = run({kr5(), plan, simulation_options()});
  const auto found = strokes(cycles, 0.004);

  std::size_t next = 0;
  const auto expect = [&](std::size_t joint, double from_deg, double to_deg, double speed_deg_s) {
    if (from_deg == to_deg) return;
    CAPTURE(file, joint, from_deg, to_deg);
    REQUIRE(next < found.size());
    const auto& stroke = found[next++];
    CHECK(stroke.joint == joint);
    CHECK(stroke.from_deg == from_deg);
    CHECK(stroke.to_deg == to_deg);
    // Every move of these plans is long enough to reach its speed, and for more than a cycle.
    CHECK(stroke.peak_deg_s == Approx(speed_deg_s).epsilon(1e-9));
    CHECK(stroke.rest_before >= 300 / 4 - 1);
    CHECK(stroke.rest_before <= 300 / 4);
  };
  for (const auto& sweep : plan.sweeps) {
    const double home_deg = plan.home_deg[sweep.joint - 1];
    expect(sweep.joint, home_deg, sweep.start_deg, plan.positioning_speed_deg_s);
    expect(sweep.joint, sweep.start_deg, sweep.end_deg, sweep.speed_deg_s);
    expect(sweep.joint, sweep.end_deg, home_deg, plan.positioning_speed_deg_s);
  }
  CHECK(next == found.size());
  for (std::size_t j = 0; j < 6; ++j) {
    CHECK(cycles.front().ASPos[j] == plan.home_deg[j]);
    CHECK(cycles.back().ASPos[j] == plan.home_deg[j]);
  }
}

TEST_CASE("no move ever exceeds the plan's acceleration", "[simulated_robot]") {
  const auto cycles = run({kr5(), table_2(), simulation_options()});
  double most = 0;
  for (std::size_t k = 2; k < cycles.size(); ++k)
    for (std::size_t j = 0; j < 6; ++j)
      most = std::max(
          most, std::abs(cycles[k].ASPos[j] - 2 * cycles[k - 1].ASPos[j] + cycles[k - 2].ASPos[j]));
  // Second differences of numbers near 100 are right to about 1e-13, over 0.004^2 to 1e-8.
  CHECK(most / (0.004 * 0.004) == Approx(200).margin(1e-7));
}

TEST_CASE("speed rises with the acceleration to the wanted one, and falls the same way",
          "[simulated_robot]") {
  // From 0 to 15 deg at 10 deg/s and 40 deg/s2: 0.25 s ramps of 1.25 deg, 1.25 s between them. Back
  // at 20 deg/s: 0.5 s ramps of 5 deg, 0.25 s between them.
  SimulatedRobot robot(planar_arm(), planar_plan(0, 15, 10), {.cycle = 50ms, .tool_mm = {}});
  CHECK(robot.duration() == 100ms + 1750ms + 100ms + 1250ms + 100ms);
  CHECK(robot.cycles() == 3300 / 50 + 1);
  const auto cycles = run(robot);
  REQUIRE(cycles.size() == robot.cycles());
  const auto angle_deg = [&](int time_ms) {
    return cycles[static_cast<std::size_t>(time_ms / 50)].ASPos[1];
  };
  CHECK(angle_deg(100) == 0);
  CHECK(angle_deg(100 + 100) == Approx(40 * 0.1 * 0.1 / 2));
  CHECK(angle_deg(100 + 250) == Approx(1.25));
  CHECK(angle_deg(100 + 1000) == Approx(1.25 + 7.5));
  CHECK(angle_deg(100 + 1500) == Approx(15 - 1.25));
  CHECK(angle_deg(100 + 1650) == Approx(15 - 40 * 0.1 * 0.1 / 2));
  CHECK(angle_deg(100 + 1750) == 15);
  CHECK(angle_deg(100 + 1850) == 15);
  CHECK(angle_deg(1950 + 500) == Approx(10));
  CHECK(angle_deg(3200) == 0);
}

TEST_CASE("a move too short for its speed turns to braking half way", "[simulated_robot]") {
  // 2.5 deg each way at 40 deg/s2: 0.25 s of speeding up, as much of braking, 10 deg/s at most.
  SimulatedRobot robot(planar_arm(), planar_plan(0, 2.5, 100), {.cycle = 50ms, .tool_mm = {}});
  CHECK(robot.duration() == 100ms + 500ms + 100ms + 500ms + 100ms);
  const auto cycles = run(robot);
  CHECK(cycles[(100 + 250) / 50].ASPos[1] == Approx(1.25));
  CHECK(cycles[(100 + 500) / 50].ASPos[1] == 2.5);
}

TEST_CASE("the run ends with the first cycle that is at rest", "[simulated_robot]") {
  auto plan = planar_plan(0, 2.5, 100);
  plan.dwell = 0ms;  // 0.5 s there, 0.5 s back
  CHECK(SimulatedRobot(planar_arm(), plan, {.cycle = 250ms, .tool_mm = {}}).cycles() == 5);
  const auto odd = run({planar_arm(), plan, {.cycle = 300ms, .tool_mm = {}}});
  CHECK(odd.size() == 5);
  CHECK(odd.back().ASPos[1] == 0);
}

TEST_CASE("the robot says which joint is at work", "[simulated_robot]") {
  SimulatedRobot robot(kr5(), table_2(), simulation_options());
  std::vector<std::size_t> joints;
  for (rsi::SignalValues values; robot.next(values);)
    if (joints.empty() || joints.back() != robot.joint()) joints.push_back(robot.joint());
  CHECK(joints == std::vector<std::size_t>{1, 2, 3, 4, 5, 6});
}

TEST_CASE("poses are the forward kinematics of the angles beside them", "[simulated_robot]") {
  const auto robot = kr5();
  const auto pose = [&](const std::array<double, 6>& angles_deg) {
    std::vector<double> angles_rad;
    for (const double angle_deg : angles_deg) angles_rad.push_back(angle_deg * kDegree);
    return identify::forward_kinematics(*robot.arm, angles_rad);
  };
  const auto check = [&](const std::array<double, 6>& wire, const Eigen::Isometry3d& expected) {
    const Eigen::Vector3d tool = expected * robot.arm->tool_mm;
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(wire[i] == Approx(tool(static_cast<Eigen::Index>(i))).margin(1e-9));
    using Eigen::AngleAxisd, Eigen::Vector3d;
    const Eigen::Matrix3d rotation = (AngleAxisd(wire[3] * kDegree, Vector3d::UnitZ()) *
                                      AngleAxisd(wire[4] * kDegree, Vector3d::UnitY()) *
                                      AngleAxisd(wire[5] * kDegree, Vector3d::UnitX()))
                                         .toRotationMatrix();
    CHECK((rotation - expected.linear()).cwiseAbs().maxCoeff() < 1e-12);
  };
  const auto cycles = run({robot, table_2(), simulation_options()});
  for (std::size_t k = 0; k < cycles.size(); k += 97) {
    CAPTURE(k);
    check(cycles[k].RIst, pose(cycles[k].AIPos));
    check(cycles[k].RSol, pose(cycles[k].ASPos));
  }
}

TEST_CASE("a tool point given takes the place of the description's", "[simulated_robot]") {
  auto with_tool = simulation_options(0);
  with_tool.tool_mm = Eigen::Vector3d(1, 2, 3);
  const auto cycles = run({planar_arm(), planar_plan(0, 10, 10), with_tool});
  CHECK(cycles.front().RIst[0] == Approx(151));
  CHECK(cycles.front().RIst[1] == Approx(2));
  CHECK(cycles.front().RIst[2] == Approx(3));
}

TEST_CASE("joints that the robot does not have are zero", "[simulated_robot]") {
  const auto cycles = run({planar_arm(), planar_plan(0, 10, 10), simulation_options()});
  REQUIRE_FALSE(cycles.empty());
  for (const auto& cycle : cycles)
    for (std::size_t j = 2; j < 6; ++j) REQUIRE((cycle.AIPos[j] == 0 && cycle.ASPos[j] == 0));
}

TEST_CASE("servos wobble with the given deviation, each for itself and anew in each cycle",
          "[simulated_robot]") {
  constexpr double sigma_deg = 0.01;
  const auto cycles = run({kr5(), table_2(), simulation_options(sigma_deg, 5)});
  const auto n = static_cast<double>(cycles.size());
  REQUIRE(n > 10'000);
  Eigen::MatrixXd wobble(cycles.size(), 6);
  for (std::size_t k = 0; k < cycles.size(); ++k)
    for (std::size_t j = 0; j < 6; ++j)
      wobble(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j)) =
          (cycles[k].AIPos[j] - cycles[k].ASPos[j]) / sigma_deg;
  // Mean, correlations: standard deviation 1/sqrt(n); variance: sqrt(2/n); fourth moment:
  // sqrt(96/n). Four of these, as there are some forty figures.
  const double unit = 4 / std::sqrt(n);
  CHECK(wobble.colwise().mean().cwiseAbs().maxCoeff() < unit);
  const Eigen::MatrixXd covariance = wobble.transpose() * wobble / n;
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = 0; j < 6; ++j)
      CHECK(covariance(i, j) == Approx(i == j ? 1 : 0).margin(i == j ? std::sqrt(2) * unit : unit));
  const auto rows = wobble.rows() - 1;
  for (Eigen::Index j = 0; j < 6; ++j) {
    CHECK(std::abs(wobble.col(j).head(rows).dot(wobble.col(j).tail(rows)) / n) < unit);
    CHECK(wobble.col(j).array().pow(4).mean() == Approx(3).margin(std::sqrt(96) * unit));
  }
}

TEST_CASE("a seed tells the wobble, and a wobble of zero is none", "[simulated_robot]") {
  const auto angles = [](double wobble_deg, std::uint64_t seed) {
    std::vector<std::array<double, 6>> result;
    for (const auto& cycle :
         run({planar_arm(), planar_plan(0, 10, 10), simulation_options(wobble_deg, seed)}))
      result.push_back(cycle.AIPos);
    return result;
  };
  CHECK(angles(1e-4, 3) == angles(1e-4, 3));
  CHECK(angles(1e-4, 3) != angles(1e-4, 4));
  for (const auto& cycle : run({kr5(), table_2(), simulation_options(0)})) {
    REQUIRE(cycle.AIPos == cycle.ASPos);
    REQUIRE(cycle.RIst == cycle.RSol);
  }
}

TEST_CASE("A, B, C give their rotation back, also where they are not unique", "[simulated_robot]") {
  using Eigen::AngleAxisd, Eigen::Vector3d, Eigen::Matrix3d;
  const auto rotation = [](double a_deg, double b_deg, double c_deg) -> Matrix3d {
    return (AngleAxisd(a_deg * kDegree, Vector3d::UnitZ()) *
            AngleAxisd(b_deg * kDegree, Vector3d::UnitY()) *
            AngleAxisd(c_deg * kDegree, Vector3d::UnitX()))
        .toRotationMatrix();
  };
  for (const double a : {-170.0, -30.0, 0.0, 90.0, 125.0})
    for (const double b : {-90.0, -90 + 1e-7, -45.0, 0.0, 60.0, 90 - 1e-12, 90.0})
      for (const double c : {-90.0, 0.0, 10.0, 179.0}) {
        CAPTURE(a, b, c);
        const auto abc = sweepd::kuka_abc_deg(rotation(a, b, c));
        CHECK((rotation(abc[0], abc[1], abc[2]) - rotation(a, b, c)).cwiseAbs().maxCoeff() < 1e-12);
        if (std::abs(b) < 89) {
          CHECK(abc[0] == Approx(a).margin(1e-9));
          CHECK(abc[1] == Approx(b).margin(1e-9));
          CHECK(abc[2] == Approx(c).margin(1e-9));
        }
      }
  // Exactly singular: atan2 of zeros.
  Matrix3d down;
  down << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const auto abc = sweepd::kuka_abc_deg(down);
  CHECK((rotation(abc[0], abc[1], abc[2]) - down).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("a robot that cannot be simulated, or not with this plan, is told what to do",
          "[simulated_robot]") {
  const auto plan = planar_plan(0, 10, 10);
  auto unknown = planar_arm();
  unknown.arm.reset();
  CHECK_THROWS_AS(SimulatedRobot(unknown, plan, simulation_options()), ConfigError);
  CHECK_THROWS_WITH(SimulatedRobot(unknown, plan, simulation_options()),
                    ContainsSubstring("planar") && ContainsSubstring("found none: add b_mm"));

  auto seven = planar_arm();
  seven.limits.resize(7);
  CHECK_THROWS_AS(SimulatedRobot(seven, plan, simulation_options()), ConfigError);
  CHECK_THROWS_WITH(SimulatedRobot(seven, plan, simulation_options()),
                    ContainsSubstring("at most 6 joints"));

  auto narrow = planar_arm();
  narrow.limits[1] = {1, 5};
  CHECK_THROWS_AS(SimulatedRobot(narrow, plan, simulation_options()), ConfigError);
  CHECK_THROWS_WITH(SimulatedRobot(narrow, plan, simulation_options()),
                    ContainsSubstring("home_deg: expected joint 2 from 1 to 5") &&
                        ContainsSubstring("\nplan.toml:7: sweep.end_deg"));
}

TEST_CASE("options that no robot can have are refused", "[simulated_robot]") {
  const auto robot = planar_arm();
  const auto plan = planar_plan(0, 10, 10);
  for (const auto cycle : {0ms, 1001ms})
    CHECK_THROWS_AS(SimulatedRobot(robot, plan, {.cycle = cycle, .tool_mm = {}}),
                    std::invalid_argument);
  for (const double wobble_deg : {-1e-4, std::nan(""), HUGE_VAL})
    CHECK_THROWS_AS(SimulatedRobot(robot, plan, simulation_options(wobble_deg)),
                    std::invalid_argument);
  auto nowhere = simulation_options();
  nowhere.tool_mm = Eigen::Vector3d(0, std::nan(""), 0);
  CHECK_THROWS_AS(SimulatedRobot(robot, plan, nowhere), std::invalid_argument);
}
