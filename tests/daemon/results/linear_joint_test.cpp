#include <random>

#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "daemon/plan/plan_outlook.hpp"
#include "daemon/plan/plan_text.hpp"
#include "daemon/results/models.hpp"
#include "daemon/results/report.hpp"
#include "daemon/results/result_formats.hpp"
#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/chain_outcomes.hpp"
#include "tests/daemon/scara.hpp"
#include "tests/daemon/texts.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;

namespace {

/// What is wrong with a description, or a plan.
template <class Load>
std::string complaint_of(const std::string& text, const Load& load) {
  const TemporaryFolder folder;
  try {
    (void)load(folder.write("file.toml", text));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

/// Identified once for all tests.
const Outcome& scara() {
  static const Outcome outcome = scara_outcome();
  return outcome;
}

}  // namespace

TEST_CASE("a robot description names linear joints, with limits in mm", "[linear_joint]") {
  const RobotDescription robot = scara_description();
  CHECK(robot.arm->linear == std::vector<bool>{false, false, true, false});
  CHECK(robot.limits[2].linear);
  CHECK(robot.limits[2].max_deg == 200);
  CHECK(robot.limits[2].max_speed_deg_s == 1200);
  CHECK_FALSE(robot.limits[1].linear);
  const auto complaint = [](const char* old, const char* by) {
    return complaint_of(replaced(kScara, old, by), load_robot);
  };
  CHECK_THAT(complaint("type = \"linear\"", "type = \"prismatic\""),
             ContainsSubstring("expected \"revolute\" or \"linear\""));
  CHECK_THAT(complaint("max_mm", "max_deg"),
             ContainsSubstring("expected max_mm of a joint with type = \"linear\""));
  CHECK_THAT(complaint("type = \"linear\"", ""),
             ContainsSubstring("expected min_deg of a joint with type = \"revolute\""));
  CHECK_THAT(complaint("theta_deg = 15.0\na_mm = 0.0", "theta_deg = 15.0\na_mm = 3.0"),
             ContainsSubstring("expected 0, as the joint is linear"));
}

TEST_CASE("a plan says mm of linear joints, reads itself back, and knows which joint is which",
          "[linear_joint]") {
  const SweepPlan plan = scara_plan();
  CHECK(plan.sweeps[2].linear);
  CHECK(plan.sweeps[2].end_deg == 180);
  const std::string text = plan_toml(plan);
  CHECK_THAT(text, ContainsSubstring("start_mm = 20"));
  const TemporaryFolder folder;
  const SweepPlan again = load_plan(folder.write("again.toml", text));
  CHECK(plan_toml(again) == text);
  CHECK(check_plan(plan, scara_description()).empty());
  SweepPlan wrong = plan;
  wrong.sweeps[2].linear = false;
  wrong.sweeps[3].linear = true;
  const auto findings = check_plan(wrong, scara_description());
  REQUIRE(findings.size() == 2);
  CHECK_THAT(findings[0],
             ContainsSubstring("expected start_mm, end_mm and speed_mm_s, as joint 3 is linear"));
  CHECK_THAT(findings[1],
             ContainsSubstring("expected start_deg, end_deg and speed_deg_s, as joint 4 turns"));
  wrong = plan;
  wrong.sweeps[2].end_deg = 250;
  CHECK_THAT(check_plan(wrong, scara_description()).front(),
             ContainsSubstring("sweep.end_mm: expected joint 3 from 0 to 200 mm, found 250"));
  CHECK_THAT(complaint_of(replaced(kScaraPlan, "end_mm", "end_deg"), load_plan),
             ContainsSubstring("end_deg"));
}

TEST_CASE("a SCARA is complete, and its results say mm where the linear joint's are",
          "[linear_joint]") {
  const Outcome& outcome = scara();
  REQUIRE(outcome.identification.status == identify::Status::complete);
  const auto json = nlohmann::json::parse(result_json(outcome));
  const auto& joint = json["joints"][2];
  CHECK(joint["type"] == "linear");
  CHECK_FALSE(json["joints"][1].contains("type"));
  REQUIRE(joint["sweeps"][1]["used"] == true);
  CHECK_THAT(joint["sweeps"][1]["range_mm"].get<double>(), WithinAbs(160, 1));
  CHECK_FALSE(joint["sweeps"][1].contains("range_deg"));
  CHECK(joint["axis"]["point_sigma_mm"].is_null());
  CHECK(joint["axis"]["by_convention"] == nlohmann::json{"point"});
  CHECK(joint["axis"]["direction_sigma_deg"].get<double>() > 0);
  CHECK_THAT(joint["line"]["length_mm"].get<double>(), WithinAbs(160, 1));
  CHECK_FALSE(joint.contains("circle"));
  CHECK_THAT(json["home_deg"][2].get<double>(), WithinAbs(100, 0.01));
  CHECK(json["dh"][2]["variable"] == "b_mm");
  CHECK(json["dh"][2]["by_convention"] == nlohmann::json{"b_mm", "theta_deg", "a_mm"});
  CHECK_THAT(json["dh"][2]["theta_deg"].get<double>(), WithinAbs(15, 1e-6));
  CHECK(json["dh"][2]["alpha_sigma_deg"].get<double>() > 0);
  CHECK_THAT(json["dh"][1]["a_mm"].get<double>(), WithinAbs(300, 0.01));
  const auto& angles = json["estimates"]["chain"]["angles"][2];
  CHECK(angles.contains("error_rms_mm"));
  CHECK_FALSE(angles.contains("error_rms_arcsec"));
  CHECK(json["models"]["exponentials"]["joints"][2]["type"] == "linear");
}

TEST_CASE("the report and the tables of a SCARA have its linear joint's lengths",
          "[linear_joint]") {
  const Outcome& outcome = scara();
  const std::string text = report(outcome);
  CHECK_THAT(text, ContainsSubstring("A2 60.000 deg, A3 100.000 mm, A4 -30.000 deg"));
  CHECK_THAT(text, ContainsSubstring("joint  sweeps  used  samples   way mm"));
  CHECK_THAT(text, ContainsSubstring("joint 3: b changes, theta stays"));
  CHECK_THAT(text, ContainsSubstring("of linear joints in µm"));
  const std::string dh = dh_csv(outcome);
  CHECK_THAT(dh, ContainsSubstring(",b_mm\n"));
  const std::string sweeps = sweeps_csv(outcome);
  CHECK_THAT(sweeps, ContainsSubstring("\n3,"));
  std::istringstream lines(sweeps);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("3,")) {
      CHECK_THAT(line, ContainsSubstring(",,,1"));  // no error in arcsec
      break;
    }
}

TEST_CASE("every model of a SCARA moves as its chain, to 1e-9 m", "[linear_joint]") {
  const Outcome& outcome = scara();
  const auto models = models_of(outcome);
  REQUIRE(models.size() == identify::kModelForms.size());
  std::mt19937 random(5);
  for (const auto& model : models) {
    CAPTURE(identify::text(model.form));
    CHECK(model.linear == std::vector<bool>{false, false, true, false});
    for (int k = 0; k < 50; ++k) {
      const auto turns = random_turns(random);
      const auto pose = identify::forward_kinematics(model, turns);
      CHECK(misfit_mm(outcome, turns, pose) < 1e-6);
    }
  }
  CHECK_THAT(models_csv(models), ContainsSubstring("exponentials,3,wx,0,1,,,,by_convention"));
}

TEST_CASE("a linear joint is prismatic in a URDF, in metres, and without limits by what was swept",
          "[linear_joint]") {
  Outcome outcome = scara();
  const auto model = models_of(outcome).back();
  const auto joint_of = [&](pugi::xml_document& xml) {
    REQUIRE(xml.load_string(urdf(model, outcome).c_str()));
    return xml.child("robot").find_child_by_attribute("joint", "name", "joint_3");
  };
  pugi::xml_document xml;
  const auto joint = joint_of(xml);
  CHECK(joint.attribute("type").value() == std::string("prismatic"));
  CHECK(joint.child("limit").attribute("lower").as_double() == 0);
  CHECK(joint.child("limit").attribute("upper").as_double() == Approx(0.2));
  CHECK(joint.child("limit").attribute("velocity").as_double() == Approx(1.2));
  outcome.limits.clear();
  pugi::xml_document other;
  const auto swept = joint_of(other).child("limit");
  CHECK_THAT(swept.attribute("lower").as_double(), WithinAbs(0.02, 0.001));
  CHECK_THAT(swept.attribute("upper").as_double(), WithinAbs(0.18, 0.001));
}

TEST_CASE("a plan of a SCARA is looked at in mm, and a stroke of 3 mm refused in mm",
          "[linear_joint]") {
  const RobotDescription robot = scara_description();
  Measurement measurement;
  measurement.cycle = std::chrono::milliseconds(12);
  const PlanOutlook outlook = look_ahead(robot, scara_plan(), measurement, 1);
  CHECK(outlook.refusals.empty());
  CHECK(outlook.axes[2] == AxisOutlook::good);
  const std::string text = plan_text(robot, outlook, measurement);
  CHECK_THAT(text, ContainsSubstring("20.000 mm  180.000 mm"));
  CHECK_THAT(text, ContainsSubstring("50.00 mm/s"));
  SweepPlan little = scara_plan();
  little.sweeps[2].start_deg = 98.5;
  little.sweeps[2].end_deg = 101.5;
  const PlanOutlook refused = look_ahead(robot, little, measurement, 1);
  REQUIRE_FALSE(refused.refusals.empty());
  CHECK_THAT(refused.refusals.front(),
             ContainsSubstring("98.5 to 101.5 mm) would not be used: it is shorter than 5 mm"));
}
