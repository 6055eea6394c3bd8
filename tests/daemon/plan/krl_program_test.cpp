#include "daemon/plan/krl_program.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/plan/krl_checker.hpp"
#include "tests/daemon/texts.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

namespace {

SweepPlan plan_90() {
  return load_plan(kConfig / "plans/kr5_arc_90deg.toml");
}

KrlOptions krl_options(KrlDialect dialect) {
  KrlOptions options;
  options.dialect = dialect;
  options.name = "kr5_arc";
  options.limits = load_robot(kConfig / "robots/kr5_arc.toml").limits;
  options.limits[4].max_speed_deg_s = std::numeric_limits<double>::infinity();  // not known
  return options;
}

std::array<std::optional<double>, 6> pose(const std::vector<double>& angles_deg) {
  std::array<std::optional<double>, 6> pose{};
  std::copy(angles_deg.begin(), angles_deg.end(), pose.begin());
  return pose;
}

std::vector<std::string> calls(const KrlReport& report) {
  std::vector<std::string> names;
  for (const KrlEvent& event : report.events)
    if (event.kind == KrlEvent::Kind::call && event.function != "BAS")
      names.push_back(event.function);
  return names;
}

std::vector<std::string> expected_calls(KrlDialect dialect) {
  switch (dialect) {
    case KrlDialect::krc2:
      return {"ST_ETHERNET", "ST_SETPARAM", "ST_SETPARAM", "ST_SETPARAM", "ST_ON", "ST_OFF"};
    case KrlDialect::krc4:
      return {"RSI_CREATE", "RSI_ON", "RSI_OFF", "RSI_DELETE"};
    case KrlDialect::iiqka:
      break;
  }
  return {"RSI_LOAD", "RSI_ACTIVATE", "RSI_PROCESS_ON", "RSI_PROCESS_OFF"};
}

}  // namespace

TEST_CASE("a program runs the sweeps of its plan, each between rests and from home to home",
          "[krl_program]") {
  const auto dialect = GENERATE(KrlDialect::krc2, KrlDialect::krc4, KrlDialect::iiqka);
  const auto* const file = GENERATE("plans/kr5_arc_90deg.toml", "plans/kr5_arc_30deg.toml");
  const SweepPlan plan = load_plan(kConfig / file);
  const RobotDescription robot = load_robot(kConfig / "robots/kr5_arc.toml");
  const KrlProgram program = krl_program(plan, krl_options(dialect));
  const KrlReport report = check_krl(program.src, program.dat, robot.limits);
  INFO(program.src << program.dat);
  CHECK(joined(report.mistakes) == "");
  CHECK(report.name == "KR5_ARC");
  CHECK(calls(report) == expected_calls(dialect));

  std::vector<KrlEvent> events;  // from the first PTP on, without calls
  for (const KrlEvent& event : report.events)
    if (event.kind != KrlEvent::Kind::call) events.push_back(event);
  auto event = events.begin();
  const auto expect_move = [&](const std::vector<double>& angles_deg) {
    REQUIRE(event != events.end());
    CHECK(event->kind == KrlEvent::Kind::move);
    CHECK(event++->axes_deg == pose(angles_deg));
  };
  const auto expect_wait = [&](double least_s) {
    REQUIRE(event != events.end());
    CHECK(event->kind == KrlEvent::Kind::wait);
    CHECK(event++->seconds >= least_s);
  };
  const double dwell_s = std::chrono::duration<double>(plan.dwell).count();
  expect_move(plan.home_deg);
  expect_wait(0);
  expect_wait(dwell_s);  // RSI is on
  for (const PlannedSweep& sweep : plan.sweeps) {
    auto angles_deg = plan.home_deg;
    angles_deg[sweep.joint - 1] = sweep.start_deg;
    expect_move(angles_deg);
    expect_wait(dwell_s);
    angles_deg[sweep.joint - 1] = sweep.end_deg;
    expect_move(angles_deg);
    expect_wait(dwell_s);
    expect_move(plan.home_deg);
  }
  expect_wait(dwell_s);
  CHECK(event == events.end());
}

TEST_CASE("RSI is on before the first sweep and off after the last", "[krl_program]") {
  const auto dialect = GENERATE(KrlDialect::krc2, KrlDialect::krc4, KrlDialect::iiqka);
  const KrlProgram program = krl_program(plan_90(), krl_options(dialect));
  const KrlReport report = check_krl(program.src, program.dat);
  const auto place = [&](const std::string& function) {
    return std::find_if(report.events.begin(), report.events.end(),
                        [&](const KrlEvent& event) { return event.function == function; }) -
           report.events.begin();
  };
  const auto names = expected_calls(dialect);
  const auto on = std::find_if(names.begin(), names.end(),
                               [](const auto& name) { return name.ends_with("_ON"); });
  REQUIRE(on != names.end());
  std::vector<std::ptrdiff_t> moves;
  for (std::size_t i = 0; i < report.events.size(); ++i)
    if (report.events[i].kind == KrlEvent::Kind::move)
      moves.push_back(static_cast<std::ptrdiff_t>(i));
  REQUIRE(moves.size() == 1 + 3 * 6);
  CHECK(moves[0] < place(*on));
  CHECK(place(*on) < moves[1]);
  CHECK(moves.back() < place(*(on + 1)));
}

TEST_CASE("each call of RSI is followed by a halt and a return, should it fail", "[krl_program]") {
  const auto dialect = GENERATE(KrlDialect::krc2, KrlDialect::krc4, KrlDialect::iiqka);
  const std::string src = krl_program(plan_90(), krl_options(dialect)).src;
  const std::string ok = dialect == KrlDialect::krc2 ? "#RSIOK" : "RSIOK";
  std::size_t results = 0;
  for (auto at = src.find("SWD_RESULT = "); at != std::string::npos;
       at = src.find("SWD_RESULT = ", at + 1)) {
    ++results;
    const std::string after = src.substr(src.find("\r\n", at) + 2, 200);
    CHECK_THAT(after, Catch::Matchers::StartsWith("IF (SWD_RESULT <> " + ok + ") THEN\r\n  HALT"));
    CHECK_THAT(after, ContainsSubstring("  RETURN\r\nENDIF"));
  }
  CHECK(results == expected_calls(dialect).size());
}

TEST_CASE("speeds are whole per cent of what an axis can do, never more than the plan asks for",
          "[krl_program]") {
  const SweepPlan plan = plan_90();
  const KrlOptions known = krl_options(KrlDialect::krc4);
  const KrlProgram program = krl_program(plan, known);
  const KrlReport report = check_krl(program.src, program.dat);
  std::size_t sweep = 0;
  int moves = 0;
  for (const KrlEvent& event : report.events) {
    if (event.kind != KrlEvent::Kind::move || moves++ % 3 != 2) continue;  // the sweep itself
    const std::size_t joint = plan.sweeps[sweep].joint;
    const int percent = event.speed_percent.at(static_cast<int>(joint));
    INFO("joint " << joint);
    if (joint == 5) {
      CHECK(percent == 5);
    } else {
      const double one_percent_deg_s = known.limits[joint - 1].max_speed_deg_s / 100;
      CHECK(percent * one_percent_deg_s <= plan.sweeps[sweep].speed_deg_s);
      CHECK(percent * one_percent_deg_s > plan.sweeps[sweep].speed_deg_s - one_percent_deg_s);
    }
    ++sweep;
  }
  CHECK(sweep == plan.sweeps.size());
  CHECK_THAT(program.src, ContainsSubstring("$VEL_AXIS[5] = 5 ; CHECK: "));
}

TEST_CASE("a speed beyond what an axis can do becomes all that it can", "[krl_program]") {
  KrlOptions slow = krl_options(KrlDialect::krc4);
  slow.limits[0].max_speed_deg_s = 15;
  CHECK_THAT(krl_program(plan_90(), slow).src, ContainsSubstring("$VEL_AXIS[1] = 100 "));
}

TEST_CASE("a program of four axes, one of them linear, says so", "[krl_program]") {
  SweepPlan plan;
  plan.home_deg = {20, 60, 100, -30};
  plan.positioning_speed_deg_s = 60;
  plan.sweeps = {{.joint = 3, .start_deg = 0, .end_deg = 200, .speed_deg_s = 60, .linear = true}};
  KrlOptions options;
  options.limits.resize(4);
  options.limits[2].linear = true;
  options.limits[3].max_speed_deg_s = 200;
  for (const double max_mm_s : {1000.0, std::numeric_limits<double>::infinity()}) {
    options.limits[2].max_speed_deg_s = max_mm_s;
    const std::string src = krl_program(plan, options).src;
    CHECK_THAT(src, ContainsSubstring("the plan asks for 60.0 mm/s"));
    CHECK_THAT(src, ContainsSubstring("per cent of 200.0 deg/s; the plan asks for 60.0 deg/s"));
    CHECK_THAT(src, ContainsSubstring("the tool point lies on axis 4:"));
  }
  options.limits[2].max_speed_deg_s = 10000;
  CHECK_THAT(krl_findings(plan, options).back(),
             ContainsSubstring("expected 100 mm/s or more, which is 1 % of what joint 3 can do"));
}

TEST_CASE("tool, base and RSI file are those that were asked for", "[krl_program]") {
  KrlOptions other = krl_options(KrlDialect::krc4);
  other.tool = 7;
  other.rsi_file = "sweepd_onlysend";
  const std::string src = krl_program(plan_90(), other).src;
  CHECK_THAT(src, ContainsSubstring("BAS (#TOOL,7 )") && ContainsSubstring("$BASE = $NULLFRAME") &&
                      ContainsSubstring("RSI_CREATE(\"sweepd_onlysend\",SWD_CONTEXT,TRUE)"));
  CHECK_THAT(krl_program(plan_90(), krl_options(KrlDialect::krc2)).src,
             ContainsSubstring("ST_ETHERNET(SWD_ETHERNET,0,\"sweepd_udp.xml\")") &&
                 ContainsSubstring("eERXprecision,4)"));
}

TEST_CASE("angles of more than half a turn stay as they are", "[krl_program]") {
  SweepPlan plan = plan_90();
  plan.sweeps[3].start_deg = -350;
  plan.sweeps[3].end_deg = 349.123456789;
  const KrlProgram program = krl_program(plan, krl_options(KrlDialect::krc4));
  CHECK_THAT(program.dat,
             ContainsSubstring("A4 -350.0,") && ContainsSubstring("A4 349.123456789,"));
  CHECK(joined(check_krl(program.src, program.dat).mistakes) == "");
}

TEST_CASE("a robot of fewer joints gets targets of as many axes", "[krl_program]") {
  SweepPlan plan = plan_90();
  plan.home_deg.resize(4);
  plan.sweeps.resize(4);
  const KrlProgram program = krl_program(plan, krl_options(KrlDialect::krc2));
  const KrlReport report = check_krl(program.src, program.dat);
  CHECK(joined(report.mistakes) == "");
  CHECK_THAT(program.dat, ContainsSubstring("HOME_POSE={A1 90.0,A2 -90.0,A3 90.0,A4 0.0}"));
}

TEST_CASE("the name of a plan's file cannot add lines to the program", "[krl_program]") {
  SweepPlan plan = plan_90();
  plan.file = "a\r\nPTP {A1 0}\xc3\xbc.toml";
  const KrlProgram program = krl_program(plan, krl_options(KrlDialect::krc4));
  CHECK(joined(check_krl(program.src, program.dat).mistakes) == "");
  CHECK_THAT(program.src, !ContainsSubstring("\nPTP {A1 0}"));
}

TEST_CASE("what KRL cannot express is said, and nothing is written", "[krl_program]") {
  SweepPlan plan = plan_90();
  KrlOptions given = krl_options(KrlDialect::krc4);
  std::string text;
  SECTION("more than six joints") {
    plan.home_deg.resize(7);
    text = "home_deg: expected 1 to 6 angles";
  }
  SECTION("a name too long") {
    given.name = "a_name_that_is_too_long_by_far";
    text = "24 characters at most";
  }
  SECTION("a name with a dash") {
    given.name = "kr5-arc";
    text = "found 'kr5-arc'";
  }
  SECTION("a word of KRL") {
    given.name = "Loop";
    text = "which KRL or the program uses";
  }
  SECTION("a tool that no controller has") {
    given.tool = 0;
    text = "--krl-tool: expected 1 to 128, found 0";
  }
  SECTION("an RSI file that would end the string") {
    given.rsi_file = "a\",x)";
    text = "--rsi-file: expected";
  }
  SECTION("a sweep slower than one per cent") {
    plan.sweeps[5].speed_deg_s = 7;
    text = "sweep.speed_deg_s: expected 7.21 deg/s or more";
  }
  SECTION("an angle that is none") {
    plan.sweeps[0].end_deg = std::numeric_limits<double>::quiet_NaN();
    text = "sweep.end_deg: expected an angle";
  }
  SECTION("a joint that the plan does not have") {
    plan.sweeps[0].joint = 9;
    text = "sweep.joint: expected 1 to 6";
  }
  const auto findings = krl_findings(plan, given);
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], ContainsSubstring(text));
  CHECK_THROWS_AS(krl_program(plan, given), std::invalid_argument);
}
