#include "daemon/plan/pose_plan.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/plan/krl_program.hpp"
#include "daemon/plan/plan_text.hpp"
#include "daemon/points/point_poses.hpp"
#include "daemon/points/points_file.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/plan/krl_checker.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/daemon/texts.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

namespace {

RobotDescription kr5_description() {
  return load_robot(kConfig / "robots/kr5_arc.toml");
}

/// Few candidates, so that it is quick.
PoseTask quick_task(std::size_t count) {
  PoseTask task;
  task.count = count;
  task.candidates = 120;
  return task;
}

PoseTask seen_from_a_tracker(std::size_t count) {
  PoseTask task = quick_task(count);
  task.limits.device_mm = Eigen::Vector3d(3000, 1500, 800);
  task.limits.cone_deg = 60;
  task.limits.floor_mm = 100;
  task.limits.column_mm = 250;
  task.limits.keep_out = {{{-2000, -2000, -500}, {-500, 2000, 3000}}};
  return task;
}

std::string refusal(const RobotDescription& robot, const PoseTask& task) {
  try {
    static_cast<void>(plan_poses(robot, task));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no refusal";
}

}  // namespace

TEST_CASE("Planned poses keep to limits and rules, and every way between them is free",
          "[pose_plan][long]") {
  const RobotDescription robot = kr5_description();
  const PoseTask task = seen_from_a_tracker(14);
  const PosePlan plan = plan_poses(robot, task);
  REQUIRE(plan.poses.size() == 14);
  CHECK(plan.allowed() == 120);
  const PoseRules rules(*robot.arm, task.limits);
  const auto in_radians = [](std::vector<double> angles) {
    for (double& angle : angles) angle = radians(angle);
    return angles;
  };
  const auto home = in_radians(plan.home_deg);
  auto before = home;
  for (const PlannedPose& pose : plan.poses) {
    for (std::size_t j = 0; j < robot.joints(); ++j) {
      CHECK(pose.angles_deg[j] >= robot.limits[j].min_deg + task.limits.margin_deg - 1e-3);
      CHECK(pose.angles_deg[j] <= robot.limits[j].max_deg - task.limits.margin_deg + 1e-3);
    }
    const auto at = in_radians(pose.angles_deg);
    CHECK_FALSE(rules.broken(at));
    CHECK(rules.free_way(pose.over_home ? home : before, at));
    before = at;
  }
  for (const PoseRule rule : {PoseRule::keep_out, PoseRule::floor, PoseRule::cone})
    CHECK(plan.removed[static_cast<std::size_t>(rule)] > 0);
  const std::string text = pose_plan_text(robot, plan);
  CHECK_THAT(text, ContainsSubstring("- the reflector looks away from the device"));
  CHECK_THAT(text, ContainsSubstring("CAUTION"));
}

TEST_CASE("Chosen poses are better than poses at random, and their order is short", "[pose_plan]") {
  const PosePlan plan = plan_poses(kr5_description(), quick_task(12));
  CHECK(plan.outlook.displacement_mm < plan.at_random.displacement_mm);
  const auto way = [&](const std::vector<std::size_t>& order) {
    double sum = 0;
    std::vector<double> at = plan.home_deg;
    for (const std::size_t k : order) {
      double most = 0;
      for (std::size_t j = 0; j < at.size(); ++j)
        most = std::max(most, std::abs(plan.poses[k].angles_deg[j] - at[j]));
      sum += most;
      at = plan.poses[k].angles_deg;
    }
    return sum;
  };
  std::vector<std::size_t> order(plan.poses.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  const double driven = way(order);
  std::mt19937 random(3);
  for (int draw = 0; draw < 100; ++draw) {
    std::shuffle(order.begin(), order.end(), random);
    CHECK(driven < way(order));
  }
}

TEST_CASE("Where joints are linear, margin, speed and noise are told for both kinds",
          "[pose_plan]") {
  RobotDescription robot = kr5_description();
  const PosePlan plan = plan_poses(robot, quick_task(12));
  CHECK_THAT(pose_plan_text(robot, plan), !ContainsSubstring("linear"));
  robot.limits[0].linear = true;
  const std::string text = pose_plan_text(robot, plan);
  CHECK_THAT(text, ContainsSubstring(" deg/s (linear joints: mm/s)"));
  CHECK_THAT(text, ContainsSubstring(" deg (linear joints: mm) off the joint limits"));
}

TEST_CASE("Too few poses, no poses left, a forbidden home and no table are refused with reasons",
          "[pose_plan]") {
  const RobotDescription robot = kr5_description();
  CHECK_THAT(refusal(robot, quick_task(10)), ContainsSubstring("6 joints need 11 poses at least"));
  PoseTask task = seen_from_a_tracker(12);
  task.candidates = 20;
  task.limits.cone_deg = 1;
  CHECK_THAT(refusal(robot, task),
             ContainsSubstring("the reflector looks away from the device: ") &&
                 ContainsSubstring("move the device"));
  task.limits.floor_mm = 5000;
  CHECK_THAT(refusal(robot, task), ContainsSubstring("home_deg") && ContainsSubstring("floor"));
  task = quick_task(12);
  task.limits.margin_deg = 88;
  CHECK_THAT(refusal(robot, task), ContainsSubstring("--margin-deg 88: joint 3"));
  RobotDescription bare = robot;
  bare.arm.reset();
  CHECK_THAT(refusal(bare, quick_task(12)), ContainsSubstring("no DH table"));
}

TEST_CASE("The program drives to every pose and rests there, by RSI only where a file is named",
          "[pose_plan][long]") {
  const RobotDescription robot = kr5_description();
  PosePlan plan = plan_poses(robot, quick_task(12));
  plan.poses[3].over_home = true;
  KrlOptions options;
  options.dialect = GENERATE(KrlDialect::krc2, KrlDialect::krc4, KrlDialect::iiqka);
  options.name = "poses";
  options.limits = robot.limits;
  options.limits[4].max_speed_deg_s = std::numeric_limits<double>::infinity();  // not known
  if (GENERATE(false, true)) options.rsi_file = "sweepd.rsi";
  const KrlProgram program = krl_program(plan, options);
  const KrlReport report = check_krl(program.src, program.dat, robot.limits);
  INFO(program.src << program.dat);
  CHECK(joined(report.mistakes) == "");
  std::vector<KrlEvent> moves;
  std::size_t rests = 0, calls = 0;
  for (const KrlEvent& event : report.events) {
    if (event.kind == KrlEvent::Kind::move) moves.push_back(event);
    if (event.kind == KrlEvent::Kind::wait && event.seconds == 2) ++rests;
    if (event.kind == KrlEvent::Kind::call && event.function != "BAS") ++calls;
  }
  CHECK(rests == 12);
  CHECK((calls > 0) == !options.rsi_file.empty());
  REQUIRE(moves.size() == 12 + 3);  // home before, after, and once between
  CHECK(moves[1].axes_deg[0] == plan.poses[0].angles_deg[0]);
  CHECK(moves[4].axes_deg[0] == plan.home_deg[0]);
  CHECK(moves[5].axes_deg[2] == plan.poses[3].angles_deg[2]);
  // 20 deg/s of 154: rounded down, and what is not known is 5 per cent.
  CHECK(moves[1].speed_percent.at(1) == 12);
  CHECK(moves[1].speed_percent.at(5) == 5);
}

TEST_CASE("The table of poses is a file of static poses once positions are filled in",
          "[pose_plan]") {
  const PosePlan plan = plan_poses(kr5_description(), quick_task(12));
  std::string table = pose_table(plan);
  const TemporaryFolder folder;
  const auto open = PointsReader({}, 6).read(folder.write("open.csv", table), {});
  CHECK(holds_poses(open));
  CHECK(static_poses(open, 6).empty());
  for (std::size_t at = 0; (at = table.find(",,,", at)) != std::string::npos;)
    table.replace(at, 3, ",1,2,3");
  const auto poses = static_poses(PointsReader({}, 6).read(folder.write("p.csv", table), {}), 6);
  REQUIRE(poses.size() == 12);
  CHECK(poses[7].sample.position_mm == Eigen::Vector3d(1, 2, 3));
  CHECK(degrees(poses[7].sample.angles_rad[4]) == Approx(plan.poses[7].angles_deg[4]));
}
