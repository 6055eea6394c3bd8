#include "tests/daemon/plan/krl_checker.hpp"

#include "daemon/plan/krl_program.hpp"
#include "rsi/ascii.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/daemon/texts.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

namespace {

/// The first of `text` becomes `other`.
}  // namespace

TEST_CASE("the checker finds mistakes that were planted", "[krl_checker]") {
  const RobotDescription robot = load_robot(kConfig / "robots/kr5_arc.toml");
  KrlProgram program =
      krl_program(load_plan(kConfig / "plans/kr5_arc_90deg.toml"), {.name = "kr5_arc"});
  REQUIRE(joined(check_krl(program.src, program.dat, robot.limits).mistakes) == "");
  std::string text;
  SECTION("an IF that does not end") {
    program.src = replaced(program.src, "ENDIF\r\n", "");
    text = "expected ENDIF for IF";
  }
  SECTION("a fold that does not end") {
    program.src = replaced(program.src, ";ENDFOLD (INI)\r\n", "");
    text = "has no ENDFOLD";
  }
  SECTION("an END that lacks") {
    program.src = replaced(program.src, "\r\nEND\r\n", "\r\n");
    text = "DEF of line 5 has no END";
  }
  SECTION("an undeclared variable") {
    program.dat = replaced(program.dat, "DECL INT SWD_RESULT\r\n", "");
    text = "SWD_RESULT is not declared";
  }
  SECTION("a variable that nothing uses") {
    program.dat = replaced(program.dat, "ENDDAT", "DECL INT SPARE\r\nENDDAT");
    text = "SPARE is never used";
  }
  SECTION("a declaration too late") {
    program.src = replaced(program.src, "\r\nEND\r\n", "\r\nDECL INT LATE\r\nEND\r\n");
    text = "a declaration after the first statement";
  }
  SECTION("an axis beyond its limit") {
    program.dat = replaced(program.dat, "A2 -130.0", "A2 -190.0");
    text = "A2 beyond its limit";
  }
  SECTION("an unknown function") {
    program.src = replaced(program.src, "RSI_ON(", "RSI_START(");
    text = "RSI_START is not declared";
  }
  SECTION("approximation") {
    program.src = replaced(program.src, "PTP HOME_POSE", "PTP HOME_POSE C_PTP");
    text = "approximation";
  }
  SECTION("a data list of another program") {
    program.dat = replaced(program.dat, "DEFDAT kr5_arc", "DEFDAT kr6");
    text = "expected the name KR6, found KR5_ARC";
  }
  SECTION("a target that is no pose") {
    program.src = replaced(program.src, "PTP HOME_POSE", "PTP REST_S");
    text = "expected axis angles for PTP";
  }
  SECTION("a line end of another system") {
    program.src = replaced(program.src, "\r\n", "\n");
    text = "expected CR LF";
  }
  SECTION("a parenthesis too few") {
    program.src = replaced(program.src, "RSI_OFF()", "RSI_OFF(");
    text = "parentheses do not match";
  }
  SECTION("a speed of more than everything") {
    program.src = replaced(program.src, "$VEL_AXIS[1] = ", "$VEL_AXIS[1] = 99");
    text = "expected a speed of 1 to 100 per cent";
  }
  CHECK_THAT(joined(check_krl(program.src, program.dat, robot.limits).mistakes),
             ContainsSubstring(text));
}

TEST_CASE("the KRL files for the controller hold what the checker knows, and move nothing",
          "[krl_checker]") {
  const auto* const name =
      GENERATE("krc2/sweepd_link", "krc2/sweepd_actpos", "krc4/sweepd_link", "krc5/sweepd_link");
  const auto file = kConfig / "controller" / (std::string(name) + ".src");
  INFO(file);
  const KrlReport report = check_krl(content(file), "");
  CHECK(joined(report.mistakes) == "");
  CHECK(rsi::equal_ignoring_case(report.name, file.stem().string()));
  double seconds = 0;
  for (const KrlEvent& event : report.events) {
    if (event.kind == KrlEvent::Kind::wait) seconds += event.seconds;
    if (event.kind == KrlEvent::Kind::move)  // to where it stands already
      CHECK(event.axes_deg == std::array<std::optional<double>, 6>{});
  }
  CHECK(seconds >= 30);
}
