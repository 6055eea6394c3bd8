#include "daemon/settings/robot_setup.hpp"

#include <utility>

#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::ConfigError;
using sweepd::load_setup;
using sweepd::radians;
using sweepd::test::kConfig;
using sweepd::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

sweepd::RobotSettings robot_settings() {
  sweepd::RobotSettings robot;
  robot.name = "cell-7";
  robot.description = kConfig / "robots/kr5_arc.toml";
  robot.plan = kConfig / "plans/kr5_arc_90deg.toml";
  robot.signals.position = {"Act_X", "Act_Y", "Act_Z"};
  return robot;
}

}  // namespace

TEST_CASE("a setup has the name and signals of the settings, and what their files hold",
          "[robot_setup]") {
  const auto setup = load_setup(robot_settings());
  CHECK(setup.name == "cell-7");
  CHECK(setup.joints == 6);
  CHECK(setup.signals.position[0] == "Act_X");
  REQUIRE(setup.description);
  CHECK(setup.description->arm.has_value());
  REQUIRE(setup.plan);
  CHECK(setup.plan->sweeps.size() == 6);
}

TEST_CASE("without files there are six joints and nothing to compare with", "[robot_setup]") {
  const auto setup = load_setup({}, {});
  CHECK(setup.joints == 6);
  CHECK_FALSE(setup.name.empty());
  const auto campaign = sweepd::campaign(setup, {});
  CHECK(campaign.joints == 6);
  CHECK_FALSE(campaign.specified.has_value());
  CHECK(campaign.order.empty());
  CHECK(campaign.declared_home_rad.empty());
}

TEST_CASE("a description gives its name and joints, a plan alone its joints", "[robot_setup]") {
  const TemporaryFolder folder;
  const auto robot = folder.write("two_joints.toml",
                                  "name = \"small\"\nhome_deg = [0, 0]\n[[joint]]\n[[joint]]\n");
  CHECK(load_setup(robot, {}).name == "two-joints");
  CHECK(load_setup(robot, {}).joints == 2);
  const auto plan = folder.write(
      "plan.toml",
      "home_deg = [0, 0, 0]\npositioning_speed_deg_s = 10\nacceleration_deg_s2 = 100\n"
      "dwell_ms = 300\n[[sweep]]\njoint = 3\nstart_deg = 0\nend_deg = 50\nspeed_deg_s = 10\n");
  CHECK(load_setup({}, plan).joints == 3);
  SECTION("a plan for another robot is refused with file and line") {
    CHECK_THROWS_AS(load_setup(robot, plan), ConfigError);
    CHECK_THROWS_WITH(load_setup(robot, plan), ContainsSubstring(plan.string() + ":"));
  }
}

TEST_CASE("files that are missing or wrong are configuration errors with their path",
          "[robot_setup]") {
  auto robot = robot_settings();
  robot.description = "/nowhere/robot.toml";
  CHECK_THROWS_AS(load_setup(robot), ConfigError);
  CHECK_THROWS_WITH(load_setup(robot), ContainsSubstring("/nowhere/robot.toml"));
  robot = robot_settings();
  robot.plan = "/nowhere/plan.toml";
  CHECK_THROWS_AS(load_setup(robot), ConfigError);
  CHECK_THROWS_WITH(load_setup(robot), ContainsSubstring("/nowhere/plan.toml"));
}

TEST_CASE("a campaign is the plan in radians, with joints from 0 and their first directions",
          "[robot_setup]") {
  const identify::Resolution resolution{1e-4, 1e-6};
  const auto campaign = sweepd::campaign(load_setup(robot_settings()), resolution);
  CHECK(campaign.resolution.position_mm == resolution.position_mm);
  CHECK(campaign.resolution.angle_rad == resolution.angle_rad);
  REQUIRE(campaign.specified);
  REQUIRE(campaign.declared_home_rad.size() == 6);
  CHECK(campaign.declared_home_rad[1] == Approx(radians(-90)));
  // Home (90,-90,90,0,90,0); a joint that does not start at home is positioned first.
  std::vector<std::pair<std::size_t, int>> order;
  for (const auto& turn : campaign.order) order.emplace_back(turn.joint, turn.first_direction);
  CHECK(order ==
        std::vector<std::pair<std::size_t, int>>{{0, -1}, {1, 1}, {2, 1}, {3, 1}, {4, -1}, {5, 1}});
  // To its start, the sweep, and home again.
  const std::vector<double> strokes{radians(-135), radians(90), radians(45)};
  REQUIRE(campaign.order[0].strokes_rad.size() == strokes.size());
  for (std::size_t k = 0; k < strokes.size(); ++k)
    CHECK(campaign.order[0].strokes_rad[k] == Approx(strokes[k]));
  // It begins at home.
  CHECK(campaign.order[4].strokes_rad.size() == 2);
}

TEST_CASE("sweeps of one joint in a row are one turn, and a later one another", "[robot_setup]") {
  const TemporaryFolder folder;
  std::string text =
      "home_deg = [0, 0]\npositioning_speed_deg_s = 10\nacceleration_deg_s2 = 100\n"
      "dwell_ms = 300\n";
  for (const char* joint : {"1", "1", "2", "1"})
    text += std::string("[[sweep]]\njoint = ") + joint +
            "\nstart_deg = 0\nend_deg = -50\nspeed_deg_s = 10\n";
  const auto campaign = sweepd::campaign(load_setup({}, folder.write("plan.toml", text)), {});
  REQUIRE(campaign.order.size() == 3);
  CHECK(campaign.order[0].joint == 0);
  CHECK(campaign.order[1].joint == 1);
  CHECK(campaign.order[2].joint == 0);
  CHECK(campaign.order[2].first_direction == -1);
}
