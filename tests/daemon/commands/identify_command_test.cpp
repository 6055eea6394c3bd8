#include "daemon/commands/identify_command.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/commands/replay_command.hpp"
#include "daemon/commands/simulate_command.hpp"
#include "daemon/points/csv_file.hpp"
#include "daemon/settings/toml_table.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/arm_axes.hpp"
#include "tests/daemon/point_files.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;
using sweepd::identify_points;
using sweepd::IdentifyOptions;
using namespace sweepd::test;
namespace fs = std::filesystem;

namespace {

/// That of a controller: positions follow from the angles.
constexpr identify::test::Noise kWobble{.wobble_deg = 1e-4};
/// That of a tracker.
constexpr identify::test::Noise kTracker{.position_mm = 0.02, .seed = 5};

IdentifyOptions points_options(std::vector<fs::path> points, const fs::path& output) {
  IdentifyOptions result;
  result.points = std::move(points);
  result.robot = kConfig / "robots/kr5_arc.toml";
  result.device_frame = false;
  result.output = output;
  return result;
}

Json identified(const IdentifyOptions& wanted) {
  std::ostringstream report;
  CHECK(identify_points(wanted, report) == 0);
  CHECK(report.str() == content(*wanted.output / "report.txt"));
  INFO(report.str());
  return Json::parse(content(*wanted.output / "result.json"));
}

/// All axes were found, and no number is further from the specified one than its uncertainty
/// allows: five sigma are not passed by chance.
void check_specified(const Json& result) {
  INFO(result.dump(1));
  CHECK(result["status"] == "complete");
  CHECK(result["source"]["kind"] == "points");
  REQUIRE(result["difference"].size() == 6);
  std::size_t compared = 0;
  for (std::size_t j = 0; j < 5; ++j)
    for (const std::string name : {"b", "a", "alpha"}) {
      const std::string unit = name == "alpha" ? "_deg" : "_mm";
      const auto& difference = result["difference"][j][name + unit];
      if (difference.is_null()) continue;
      INFO(name << " of joint " << j + 1);
      // The last printed decimal is an error too.
      CHECK(std::abs(difference.get<double>()) <=
            5 * result["dh"][j][name + "_sigma" + unit].get<double>() + 2e-6);
      ++compared;
    }
  CHECK(compared == 14);  // b of the parallel pair is by convention
}

void check_usage(const IdentifyOptions& wanted, const std::string& said) {
  std::ostringstream ignored;
  CHECK_THROWS_AS(identify_points(wanted, ignored), std::invalid_argument);
  CHECK_THROWS_WITH(identify_points(wanted, ignored), ContainsSubstring(said));
}

void check_csv_error(const IdentifyOptions& wanted, const std::string& said) {
  std::ostringstream ignored;
  CHECK_THROWS_AS(identify_points(wanted, ignored), sweepd::CsvError);
  CHECK_THROWS_WITH(identify_points(wanted, ignored), ContainsSubstring(said));
}

std::vector<fs::path> files_per_joint(const TemporaryFolder& folder, const Measured& measured,
                                      const Layout& layout) {
  std::vector<fs::path> files;
  for (const auto& sweep : measured.sweeps)
    files.push_back(folder.write("joint" + std::to_string(sweep.joint) + ".csv",
                                 points_header(layout) + points_lines(sweep.samples, layout)));
  return files;
}

}  // namespace

TEST_CASE("points without times get none in the result files", "[identify_command][long]") {
  const TemporaryFolder folder;
  const Layout layout{.more = "joint,"};
  std::string lines = points_header(layout);
  for (const auto& sweep : measured_kr5(kTracker).sweeps)
    lines += points_lines(sweep.samples, layout, std::to_string(sweep.joint) + ",");
  const auto wanted = points_options({folder.write("points.csv", lines)}, folder / "out");
  const Json result = identified(wanted);
  for (const auto& joint : result["joints"])
    for (const auto& sweep : joint["sweeps"]) {
      CHECK(sweep["start_s"].is_null());
      CHECK(sweep["end_s"].is_null());
    }
  CHECK_FALSE(result.contains("not_finite"));
  const std::string sweeps = content(folder / "out/sweeps.csv");
  CHECK_THAT(sweeps, Catch::Matchers::StartsWith("joint,sweep,x_mm,"));
  // They are read again as what they are.
  auto again = points_options({folder / "out/sweeps.csv"}, folder / "again");
  CHECK(identified(again)["dh"] == result["dh"]);
}

TEST_CASE("a file that is no text is told so, and not printed", "[identify_command]") {
  const TemporaryFolder folder;
  const auto file = folder.write("trace.pcap", std::string("\xd4\xc3\xb2\xa1\x02\0\x04\0", 8));
  check_csv_error(points_options({file}, folder / "out"),
                  "trace.pcap: expected text, found binary data");
}

TEST_CASE("a stream of points gives the specified table", "[identify_command][long]") {
  const TemporaryFolder folder;
  Layout layout{.times = true, .angles = true};
  IdentifyOptions wanted;
  SECTION("with angles") {
    const auto measured = measured_kr5(kWobble);
    wanted = points_options(
        {folder.write("points.csv", points_header(layout) + points_lines(measured.stream, layout))},
        folder / "out");
  }
  SECTION("without, knowing the plan") {
    layout.angles = false;
    const auto measured = measured_kr5(kTracker);
    wanted = points_options(
        {folder.write("points.csv", points_header(layout) + points_lines(measured.stream, layout))},
        folder / "out");
    wanted.plan = kConfig / "plans/kr5_arc_90deg.toml";
  }
  const auto result = identified(wanted);
  check_specified(result);
  CHECK(result["source"]["telegrams"] == 0);
  CHECK(result["source"]["files"] == 1);
  for (const char* name : {"dh.csv", "sweeps.csv", "run.json"})
    CHECK(fs::exists(folder / "out" / name));
}

TEST_CASE("a stream of noisy positions gives the specified table, and says what its noise hides",
          "[identify_command][long]") {
  const TemporaryFolder folder;
  const Layout layout{.times = true};
  auto measured = measured_kr5({.position_mm = 0.3, .seed = 5});
  const auto written = [&] {
    return folder.write("points.csv",
                        points_header(layout) + points_lines(measured.stream, layout));
  };
  SECTION("at the paper's speed") {
    const auto result = identified(points_options({written()}, folder / "out"));
    check_specified(result);
    const auto& limit = result["source"]["motion_limit"];
    CHECK(limit["noise_mm"].get<double>() == Approx(0.3).epsilon(0.1));
    CHECK(limit["slowest_mm_s"].get<double>() == Approx(25 * 0.3).epsilon(0.1));
    CHECK_THAT(content(folder / "out/report.txt"),
               ContainsSubstring("mm in each coordinate of a position, as the stream shows it"));
    for (const auto& warning : result["warnings"]) CHECK(warning["code"] != "motion_limit");
  }
  SECTION("eight times as slow, at which noise hides it") {
    for (auto& sample : measured.stream) sample.time_s *= 8;
    std::ostringstream report;
    (void)identify_points(points_options({written()}, folder / "out"), report);
    const auto result = Json::parse(content(folder / "out/result.json"));
    const auto told = std::find_if(result["warnings"].begin(), result["warnings"].end(),
                                   [](const Json& one) { return one["code"] == "motion_limit"; });
    REQUIRE(told != result["warnings"].end());
    CHECK_THAT((*told)["message"].get<std::string>(),
               ContainsSubstring("hides motion slower than"));
    if (result["status"] == "complete") check_specified(result);
  }
}

TEST_CASE("points that name their joint give the specified table", "[identify_command][long]") {
  const TemporaryFolder folder;
  Layout layout{.more = "joint,"};
  SECTION("with times and angles") {
    layout.times = layout.angles = true;
    const auto measured = measured_kr5(kWobble);
    check_specified(identified(points_options(
        {folder.write("points.csv", listed_points(measured, layout))}, folder / "out")));
  }
  SECTION("with angles alone") {
    layout.angles = true;
    const auto measured = measured_kr5(kTracker);
    check_specified(identified(points_options(
        {folder.write("points.csv", listed_points(measured, layout))}, folder / "out")));
  }
  SECTION("with nothing but a plan for the directions") {
    const auto measured = measured_kr5(kTracker);
    auto wanted = points_options({folder.write("points.csv", listed_points(measured, layout))},
                                 folder / "out");
    wanted.plan = kConfig / "plans/kr5_arc_90deg.toml";
    const auto result = identified(wanted);
    check_specified(result);
    std::size_t points = 0;
    for (const auto& sweep : measured.sweeps) points += sweep.samples.size();
    CHECK(result["source"]["points"] == points);
  }
}

TEST_CASE("points that contradict what a robot can be leave a doubtful result: exit 3",
          "[identify_command][long]") {
  const TemporaryFolder folder;
  auto measured = measured_kr5(kTracker);
  std::string code;
  SECTION("joints exchanged") {
    std::swap(measured.sweeps[1].joint, measured.sweeps[3].joint);
    code = "joints_exchanged";
  }
  SECTION("metres in a column for millimetres") {
    for (auto& sweep : measured.sweeps)
      for (auto& sample : sweep.samples) sample.position_mm /= 1000;
    code = "unit_factor";
  }
  const auto points = folder.write("points.csv", listed_points(measured, {.more = "joint,"}));
  std::ostringstream report;
  CHECK(identify_points(points_options({points}, folder / "out"), report) == 3);
  INFO(report.str());
  const auto result = Json::parse(content(folder / "out/result.json"));
  CHECK(result["status"] == "doubtful");
  CHECK(result["doubts"][0]["code"] == code);
  CHECK(report.str().find(result["doubts"][0]["message"].get<std::string>().substr(0, 30)) <
        report.str().find("theta"));
  CHECK(fs::exists(folder / "out/dh.csv"));
}

TEST_CASE("one file a joint gives the specified table", "[identify_command][long]") {
  const TemporaryFolder folder;
  Layout layout;
  SECTION("with times and angles") {
    layout.times = layout.angles = true;
    auto wanted =
        points_options(files_per_joint(folder, measured_kr5(kWobble), layout), folder / "out");
    wanted.per_joint = true;
    check_specified(identified(wanted));
  }
  SECTION("with nothing but a plan for the directions") {
    auto wanted =
        points_options(files_per_joint(folder, measured_kr5(kTracker), layout), folder / "out");
    wanted.per_joint = true;
    wanted.plan = kConfig / "plans/kr5_arc_90deg.toml";
    const auto result = identified(wanted);
    check_specified(result);
    CHECK(result["source"]["files"] == 6);
    CHECK_THAT(content(folder / "out/report.txt"), ContainsSubstring(" in 6 sweeps of 6 files\n"));
    CHECK_THAT(content(folder / "out/report.txt"), !ContainsSubstring("telegram"));
  }
}

TEST_CASE("samples.csv of a replay gives the table of the replay, digit by digit",
          "[identify_command][long]") {
  const TemporaryFolder folder;
  sweepd::SimulateOptions simulated;
  simulated.robot = kConfig / "robots/kr5_arc.toml";
  simulated.plan = kConfig / "plans/kr5_arc_30deg.toml";
  simulated.write = folder / "trace.pcap";
  simulated.quiet = true;
  std::ostringstream ignored;
  REQUIRE(sweepd::simulate(simulated, ignored, ignored) == 0);
  sweepd::ReplayOptions replayed;
  replayed.traces = {folder / "trace.pcap"};
  replayed.robot = simulated.robot;
  replayed.output = folder / "replayed";
  REQUIRE(sweepd::replay(replayed, ignored, ignored) == 0);

  const auto result =
      identified(points_options({folder / "replayed/samples.csv"}, folder / "samples"));
  CHECK(content(folder / "samples/dh.csv") == content(folder / "replayed/dh.csv"));
  CHECK(content(folder / "samples/sweeps.csv") == content(folder / "replayed/sweeps.csv"));
  CHECK(result["joints"] == Json::parse(content(folder / "replayed/result.json"))["joints"]);

  // sweeps.csv has no samples of positioning moves, and six decimals of everything.
  check_specified(identified(points_options({folder / "replayed/sweeps.csv"}, folder / "sweeps")));
}

TEST_CASE("the number of joints comes from the points where nothing else tells it",
          "[identify_command]") {
  const TemporaryFolder folder;
  std::string text = "joint,x_mm,y_mm,z_mm\n";
  for (int k = 0; k <= 60; ++k)
    text += "7," + sweepd::fixed(100 * std::cos(sweepd::radians(k)), 6) + "," +
            sweepd::fixed(100 * std::sin(sweepd::radians(k)), 6) + ",5\n";
  auto wanted = points_options({folder.write("points.csv", text)}, folder / "out");
  wanted.robot.reset();
  CHECK(identified(wanted)["joints"].size() == 7);
  wanted.joints = 9;
  CHECK(identified(wanted)["joints"].size() == 9);
  wanted.joints = 6;
  check_csv_error(wanted,
                  "points.csv: line 2, column 1 (joint): expected a whole number from 1 "
                  "to 6, found \"7\"");
  wanted.joints.reset();
  wanted.robot = kConfig / "robots/kr5_arc.toml";
  check_csv_error(wanted, "from 1 to 6, found \"7\"");
}

TEST_CASE("points in which nothing is swept are exit 1 with the reason", "[identify_command]") {
  const TemporaryFolder folder;
  std::ostringstream report;
  std::ostringstream errors;
  auto wanted = points_options(
      {folder.write("points.csv", "t_s,x_mm,y_mm,z_mm\n0,1,2,3\n1,1,2,3\n")}, folder / "out");
  CHECK(identify_points(wanted, report, errors) == 1);
  CHECK_THAT(report.str(), ContainsSubstring("failed: no sweep of a single joint was seen"));
  CHECK_THAT(report.str(), !ContainsSubstring("joint  sweeps  used"));
  CHECK(Json::parse(content(folder / "out/result.json"))["status"] == "failed");
  wanted.quiet = true;
  std::ostringstream nothing;
  errors.str("");
  CHECK(identify_points(wanted, nothing, errors) == 1);
  CHECK(nothing.str().empty());
  CHECK_THAT(errors.str(), Catch::Matchers::StartsWith("sweepd: nothing is identified: no sweep"));
}

TEST_CASE("the axes of a KR 5 as lines give its table", "[identify_command]") {
  const TemporaryFolder folder;
  std::string text = "joint,x_mm,y_mm,z_mm,dx,dy,dz\n";
  std::size_t joint = 0;
  for (const auto& axis : axes_of(identify::test::kr5_arc())) {
    text += std::to_string(++joint);
    for (const double value : axis.point_mm) text += "," + sweepd::fixed(value, 9);
    for (const double value : axis.direction) text += "," + sweepd::fixed(value, 12);
    text += "\n";
  }
  auto wanted = points_options({}, folder / "out");
  wanted.axes = folder.write("axes.csv", text);
  const auto result = identified(wanted);
  CHECK(result["status"] == "complete");
  CHECK(result["source"]["kind"] == "axes");
  CHECK_FALSE(result.contains("home_deg"));
  for (std::size_t j = 0; j < 5; ++j)
    for (const char* name : {"b_mm", "a_mm", "alpha_deg"})
      if (const auto& difference = result["difference"][j][name]; !difference.is_null())
        CHECK(std::abs(difference.get<double>()) <= 1e-6);
  CHECK_THAT(content(folder / "out/report.txt"),
             ContainsSubstring("axes        6, given as lines") &&
                 !ContainsSubstring("telegrams") && !ContainsSubstring("radius"));
  wanted.plan = kConfig / "plans/kr5_arc_90deg.toml";
  CHECK(identified(wanted)["home_deg"][1] == -90);
  wanted.plan.reset();
  wanted.axes = folder.write("axes.csv", text.substr(0, text.find("\n6,") + 1));
  check_csv_error(wanted, "axes.csv: expected the axes of 6 joints, found those of 5");
}

TEST_CASE("options that contradict each other or the files are told", "[identify_command]") {
  const TemporaryFolder folder;
  const auto listed = folder.write("listed.csv", "joint,x_mm,y_mm,z_mm\n1,0,0,0\n");
  const auto bare = folder.write("bare.csv", "x_mm,y_mm,z_mm\n0,0,0\n");
  const auto angles = folder.write("angles.csv", "t_s,x_mm,y_mm,z_mm,a1_deg,a2_deg\n0,0,0,0,1,2\n");
  check_usage(points_options({}, folder / "out"), "FILE is required");
  auto wanted = points_options({listed}, folder / "out");
  wanted.axes = listed;
  check_usage(wanted, "--axes takes the place");
  wanted = points_options({listed}, folder / "out");
  wanted.joints = 7;
  check_usage(wanted, "--joints 7: " + wanted.robot->string() + " has 6 joints");
  wanted = points_options({listed}, folder / "out");
  wanted.columns = "joint,x_mm,y_mm";
  check_usage(wanted, "--columns: expected a column for each of 3 values");
  wanted.columns = "joint,x_mm,y_mm,speed";
  check_usage(wanted, "--columns, column 4 (speed): expected a known column");
  wanted = points_options(std::vector<fs::path>(7, bare), folder / "out");
  wanted.per_joint = true;
  check_usage(wanted, "7 files for 6 joints");
  wanted.poses = true;
  check_usage(wanted, "--poses and --per-joint exclude each other: leave one out");
  wanted.poses = false;
  wanted.points = {listed};
  check_csv_error(wanted, "listed.csv: expected no column joint");
  check_csv_error(
      points_options({bare}, folder / "out"),
      "bare.csv: expected a column t_s or joint, or joint angles of static poses, found none");
  check_csv_error(points_options({angles}, folder / "out"),
                  "angles.csv: expected angles of 6 joints, found those of 2");
  check_csv_error(points_options({folder / "missing.csv"}, folder / "out"),
                  "missing.csv: cannot be read");
  wanted = points_options({listed}, folder / "out");
  wanted.robot = folder / "missing.toml";
  std::ostringstream ignored;
  CHECK_THROWS_AS(identify_points(wanted, ignored), sweepd::ConfigError);
  CHECK_FALSE(fs::exists(folder / "out"));
}
