#include "daemon/settings/sweep_plan.hpp"

#include <utility>

#include "daemon/settings/toml_table.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"

using sweepd::check_plan;
using sweepd::load_plan;
using sweepd::test::kConfig;
namespace fs = std::filesystem;

namespace {

struct PlanFile {
  sweepd::test::TemporaryFolder folder;
  fs::path path;

  explicit PlanFile(const std::string& text) : path(folder.write("plan.toml", text)) {}
};

/// The error without the file's name; "no error" if the plan is fine.
std::string plan_error(const std::string& text) {
  const PlanFile file(text);
  try {
    (void)load_plan(file.path);
  } catch (const sweepd::ConfigError& error) {
    return std::string(error.what()).substr(file.path.string().size() + 1);
  }
  return "no error";
}

const std::string kHead =
    "home_deg = [0, 10]\npositioning_speed_deg_s = 60\nacceleration_deg_s2 = 200\ndwell_ms = 0\n";
const std::string kSweep = "[[sweep]]\njoint = 2\nstart_deg = -5.5\nend_deg = 5\nspeed_deg_s = 1\n";

sweepd::RobotDescription robot_of(std::vector<sweepd::JointLimits> limits) {
  sweepd::RobotDescription robot;
  robot.limits = std::move(limits);
  return robot;
}

void check_table_2(const char* file, const std::vector<std::pair<double, double>>& ranges,
                   double speed_deg_s) {
  const auto plan = load_plan(kConfig / "plans" / file);
  CHECK(plan.home_deg == std::vector<double>{90, -90, 90, 0, 90, 0});
  CHECK(plan.dwell == std::chrono::milliseconds(300));
  CHECK(plan.positioning_speed_deg_s == 60);
  CHECK(plan.acceleration_deg_s2 == 200);
  REQUIRE(plan.sweeps.size() == ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    CHECK(plan.sweeps[i].joint == i + 1);
    CHECK(plan.sweeps[i].start_deg == ranges[i].first);
    CHECK(plan.sweeps[i].end_deg == ranges[i].second);
    CHECK(plan.sweeps[i].speed_deg_s == speed_deg_s);
  }
  CHECK(check_plan(plan, sweepd::load_robot(kConfig / "robots" / "kr5_arc.toml")).empty());
}

}  // namespace

TEST_CASE("the shipped plans are the two sets of Table 2, and a KR 5 arc can do them",
          "[sweep_plan]") {
  check_table_2("kr5_arc_90deg.toml",
                {{-45, 45}, {-60, -130}, {120, 30}, {90, 0}, {90, 0}, {0, 90}}, 20);
  check_table_2("kr5_arc_30deg.toml",
                {{-15, 15}, {-60, -90}, {120, 90}, {90, 60}, {90, 60}, {0, 30}}, 10);
}

TEST_CASE("sweeps keep the order of the file, and a joint may come again", "[sweep_plan]") {
  const PlanFile file(kHead + kSweep + "[[sweep]]\njoint = 1\nstart_deg = 0\nend_deg = 9\n" +
                      "speed_deg_s = 2.5\n" + kSweep);
  const auto plan = load_plan(file.path);
  REQUIRE(plan.sweeps.size() == 3);
  CHECK(plan.sweeps[0].joint == 2);
  CHECK(plan.sweeps[0].start_deg == -5.5);
  CHECK(plan.sweeps[0].line == 5);
  CHECK(plan.sweeps[1].joint == 1);
  CHECK(plan.sweeps[1].speed_deg_s == 2.5);
  CHECK(plan.sweeps[2].joint == 2);
  CHECK(plan.sweeps[2].line == 15);
}

TEST_CASE("a wrong figure of a plan is found in its line", "[sweep_plan]") {
  const auto sweep = [](const std::string& from, const std::string& to) {
    std::string text = kSweep;
    text.replace(text.find(from), from.size(), to);
    return plan_error(kHead + text);
  };
  CHECK(plan_error(kHead + kSweep) == "no error");
  CHECK_THAT(plan_error("name = \"x\"\n[[joint]]\n"),
             Catch::Matchers::StartsWith(
                 "2:1: joint: expected a plan of sweeps, found a robot description: "));
  CHECK_THAT(sweep("joint = 2", "joint = 3"),
             Catch::Matchers::StartsWith(
                 "6:9: sweep.joint: expected a whole number from 1 to 2, found the "
                 "number 3"));
  CHECK_THAT(sweep("joint = 2", "joint = 0"), Catch::Matchers::StartsWith("6:9: sweep.joint"));
  CHECK_THAT(
      sweep("end_deg = 5", "end_deg = -5.5"),
      Catch::Matchers::StartsWith("8:11: sweep.end_deg: expected another angle than start_deg"));
  CHECK_THAT(sweep("speed_deg_s = 1", "speed_deg_s = 0"),
             Catch::Matchers::ContainsSubstring(
                 "expected a number of degrees per second from 0.01 to 1000"));
  CHECK(sweep("speed_deg_s", "speed") ==
        "9:1: sweep.speed: unknown key: did you mean \"speed_deg_s\"?");
  CHECK_THAT(plan_error(kHead),
             Catch::Matchers::ContainsSubstring("missing: expected at least one table [[sweep]]"));
  CHECK_THAT(plan_error("home_deg = []\n" + kHead.substr(kHead.find('\n') + 1) + kSweep),
             Catch::Matchers::StartsWith("1:12: home_deg: expected 1 to 12 angles"));
  CHECK_THAT(plan_error("home_deg = [0, 1e300]\n" + kHead.substr(kHead.find('\n') + 1) + kSweep),
             Catch::Matchers::StartsWith("1:16: home_deg: expected a number of degrees from"));
}

TEST_CASE("a plan is checked against the robot that shall run it", "[sweep_plan]") {
  const PlanFile file(kHead + kSweep);
  const auto plan = load_plan(file.path);
  const std::string name = file.path.string();
  CHECK(check_plan(plan, robot_of({{}, {}})).empty());
  CHECK(check_plan(plan, robot_of({{0, 0}, {-5.5, 10}})).empty());

  const auto outside = check_plan(plan, robot_of({{1, 2}, {-5, 4}}));
  REQUIRE(outside.size() == 4);
  CHECK(outside[0] == name +
                          ": home_deg: expected joint 1 from 1 to 2 degrees, found 0: correct "
                          "it, or the limits in the robot description");
  CHECK_THAT(outside[1],
             Catch::Matchers::ContainsSubstring("home_deg: expected joint 2 from -5 to 4"));
  CHECK_THAT(outside[2],
             Catch::Matchers::StartsWith(name + ":5: sweep.start_deg: expected joint 2 from -5"));
  CHECK_THAT(outside[3], Catch::Matchers::StartsWith(name + ":5: sweep.end_deg"));

  const auto other_robot = check_plan(plan, robot_of({{}, {}, {}}));
  REQUIRE(other_robot.size() == 1);
  CHECK_THAT(other_robot[0], Catch::Matchers::ContainsSubstring(
                                 "expected 3 angles, as the robot has joints, found 2"));
}

TEST_CASE("a plan faster than a joint can move is refused, positioning included", "[sweep_plan]") {
  constexpr double kAny = 1000;
  const PlanFile file(kHead + kSweep);  // joint 2 at 1 deg/s, positioned at 60
  const auto plan = load_plan(file.path);
  const auto findings = [&](double of_joint_1, double of_joint_2) {
    return check_plan(plan, robot_of({{-kAny, kAny, of_joint_1}, {-kAny, kAny, of_joint_2}}));
  };
  CHECK(findings(0.5, 60).empty());  // joint 1 never moves
  REQUIRE(findings(60, 59).size() == 1);
  CHECK_THAT(findings(60, 59)[0],
             Catch::Matchers::ContainsSubstring("positioning_speed_deg_s: expected at most 59 "
                                                "degrees per second, as joint 2 can do no more"));
  REQUIRE(findings(60, 0.9).size() == 2);
  CHECK_THAT(findings(60, 0.9)[0],
             Catch::Matchers::StartsWith(file.path.string() + ":5: sweep.speed_deg_s: expected at "
                                                              "most 0.9 degrees per second"));
}

TEST_CASE("a plan that is written reads back as it was", "[sweep_plan]") {
  const auto plan = load_plan(kConfig / "plans" / "kr5_arc_90deg.toml");
  auto odd = plan;
  odd.home_deg = {0.1, -1e-7, 1.0 / 3, 4, 5};
  odd.dwell = std::chrono::milliseconds(0);
  odd.acceleration_deg_s2 = 1e5;
  odd.sweeps = {{5, -12.345678901234567, 1e-9, 0.01, 0}};
  for (const auto& written : {plan, odd}) {
    const PlanFile file(sweepd::plan_toml(written, "What it is.\n\nAnd why."));
    const auto read = load_plan(file.path);
    CHECK(read.home_deg == written.home_deg);
    CHECK(read.positioning_speed_deg_s == written.positioning_speed_deg_s);
    CHECK(read.acceleration_deg_s2 == written.acceleration_deg_s2);
    CHECK(read.dwell == written.dwell);
    REQUIRE(read.sweeps.size() == written.sweeps.size());
    for (std::size_t s = 0; s < read.sweeps.size(); ++s) {
      CHECK(read.sweeps[s].joint == written.sweeps[s].joint);
      CHECK(read.sweeps[s].start_deg == written.sweeps[s].start_deg);
      CHECK(read.sweeps[s].end_deg == written.sweeps[s].end_deg);
      CHECK(read.sweeps[s].speed_deg_s == written.sweeps[s].speed_deg_s);
    }
  }
  CHECK_THAT(sweepd::plan_toml(plan, "What it is.\n\nAnd why."),
             Catch::Matchers::StartsWith("# What it is.\n#\n# And why.\n\nhome_deg = [90, -90"));
}
