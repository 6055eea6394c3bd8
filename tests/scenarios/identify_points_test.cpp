#include <algorithm>

#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;

namespace {

/// Points on a quarter of a circle as a device lists them: joint, x, y, z, remark.
std::string quarter_circle(std::string_view separator) {
  std::string text;
  for (const char* point :
       {"100.000 0.000", "92.388 38.268", "70.711 70.711", "38.268 92.388", "0.000 100.000"}) {
    std::string line = "1 " + std::string(point) + " 5.000 ok";
    for (std::size_t at = 0; (at = line.find(' ', at)) != std::string::npos; at += separator.size())
      line.replace(at, 1, separator);
    text += line + "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("what a replay recorded is identified again from its samples.csv", "[identify_points]") {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  REQUIRE(run_sweepd({"simulate", "--robot", kRobot, "--plan", write_short_plan(folder).string(),
                      "--write", path("trace.pcap"), "--quiet"})
              .code == 0);
  REQUIRE(run_sweepd({"replay", path("trace.pcap"), "--robot", kRobot, "--output", path("replayed"),
                      "--quiet"})
              .code == 0);
  const auto run = run_sweepd({"identify", (folder / "replayed/samples.csv").string(), "--robot",
                               kRobot, "--frame", "robot", "--output", path("identified")});
  CHECK(run.code == 0);
  CHECK(run.errors.empty());
  CHECK(run.out == content(folder / "identified/report.txt"));
  CHECK(content(folder / "identified/dh.csv") == content(folder / "replayed/dh.csv"));
  const auto result = nlohmann::json::parse(content(folder / "identified/result.json"));
  CHECK(result["status"] == "complete");
  CHECK(result["source"]["kind"] == "points");
}

TEST_CASE("a list of points without a header is named on the command line", "[identify_points]") {
  const TemporaryFolder folder;
  for (const char* separator : {",", ";", "\t", "  "}) {
    const auto points = folder.write("points.txt", quarter_circle(separator)).string();
    for (const char* columns : {"joint,x_mm,y_mm,z_mm,-", "joint,x_mm,y_mm,z_mm,_"}) {
      const auto run = run_sweepd({"identify", "--columns", columns, points});
      INFO(run.errors);
      CHECK(run.code == 0);
      CHECK_THAT(run.out, ContainsSubstring("points      5 in 1 sweep of 1 file") &&
                              ContainsSubstring("    90.00  "));
    }
  }
  // A list of names that begins with a dash needs the equals sign.
  const auto points = folder.write("points.txt", quarter_circle(",")).string();
  CHECK(run_sweepd({"identify", "--columns=-,x_mm,y_mm,z_mm,-", "--per-joint", points}).code == 0);
}

TEST_CASE("identify: exit 1 for wrong files with line and column, 2 for usage, 78 for the robot",
          "[identify_points]") {
  const TemporaryFolder folder;
  const auto check = [&](int code, const std::vector<std::string>& arguments,
                         const std::string& said) {
    const auto run = run_sweepd(arguments);
    INFO(run.errors);
    CHECK(run.code == code);
    CHECK(run.out.empty());
    CHECK(std::count(run.errors.begin(), run.errors.end(), '\n') == 1);
    CHECK_THAT(run.errors, StartsWith("sweepd: ") && ContainsSubstring(said));
  };
  const auto points =
      folder.write("points.csv", "t_s,x_mm,y_mm,z_mm\n0.0,1,2,3\n0.1,1,abc,3\n").string();
  check(1, {"identify", points}, points + ": line 3, column 3 (y_mm): expected a number, found");
  check(1, {"identify", (folder / "missing.csv").string()}, "missing.csv: cannot be read");
  check(2, {"identify"}, "FILE is required");
  check(2, {"identify", points, "--axes", points}, "--axes");
  check(2, {"identify", points, "--joints", "13"}, "--joints");
  check(2, {"identify", points, "--frame", "world"}, "--frame");
  check(2, {"identify", points, "--columns", "t_s,x_mm,y_mm,speed"}, "column 4 (speed)");
  check(78, {"identify", points, "--robot", points}, "points.csv");
  const auto help = run_sweepd({"identify", "--help"});
  CHECK(help.code == 0);
  for (const char* word : {"--per-joint", "--columns", "--axes", "--frame", "qx, qy, qz, qw",
                           "a1_deg", "target", "direction_sigma_deg"})
    CHECK_THAT(help.out, ContainsSubstring(word));
}
