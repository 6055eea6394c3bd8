#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/commands/identify_command.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/point_files.hpp"
#include "tests/daemon/scara.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;
using sweepd::identify_points;
using sweepd::IdentifyOptions;
using namespace sweepd::test;
namespace fs = std::filesystem;

namespace {

constexpr identify::test::Noise kSeenByTracker{.position_mm = 0.02, .seed = 5};

struct AnglesRun {
  int code = 0;
  std::string out;
  std::string errors;
  Json result;
};

AnglesRun told_by_angles(const TemporaryFolder& folder, const std::string& points,
                         bool with_robot = false) {
  IdentifyOptions options;
  options.points = {folder.write("points.csv", points)};
  options.output = folder / "out";
  if (with_robot) options.robot = kConfig / "robots/kr5_arc.toml";
  std::ostringstream out;
  std::ostringstream errors;
  const int code = identify_points(options, out, errors);
  return {code, out.str(), errors.str(), Json::parse(content(folder / "out/result.json"))};
}

/// Those of a KR 5, of which the noise of a tracker hides less than this.
void check_lengths(const Json& result) {
  INFO(result.dump(1));
  CHECK(result["status"] == "complete");
  REQUIRE(result["dh"].size() == 6);
  constexpr double kFar_mm = 0.1;
  const std::vector<std::pair<std::size_t, double>> lengths{{0, 180}, {1, 600}, {2, 120}, {3, 0}};
  for (const auto& [row, a_mm] : lengths)
    CHECK(std::abs(std::abs(result["dh"][row]["a_mm"].get<double>()) - a_mm) < kFar_mm);
  CHECK(std::abs(std::abs(result["dh"][3]["b_mm"].get<double>()) - 620) < kFar_mm);
}

/// All sweeps one after the other, every tenth sample; nothing but the angles tells them apart.
std::string bare_sweeps(const Measured& measured) {
  std::string text = points_header({.angles = true});
  for (const auto& sweep : measured.sweeps) {
    std::vector<identify::Sample> some;
    for (std::size_t k = 0; k < sweep.samples.size(); k += 10) some.push_back(sweep.samples[k]);
    text += points_lines(some, {.angles = true});
  }
  return text;
}

/// Angles as a program prints them that counts from `least_deg` on.
Measured printed_from(double least_deg, Measured measured) {
  const auto print = [&](std::vector<identify::Sample>& samples) {
    for (auto& sample : samples)
      for (double& angle : sample.angles_rad) {
        const double deg = sweepd::degrees(angle) - least_deg;
        angle = sweepd::radians(least_deg + deg - 360 * std::floor(deg / 360));
      }
  };
  print(measured.stream);
  for (auto& sweep : measured.sweeps) print(sweep.samples);
  return measured;
}

}  // namespace

TEST_CASE("sweeps with angles alone are found by them where no description gives a start",
          "[identify_by_angles]") {
  const TemporaryFolder folder;
  const auto run = told_by_angles(folder, bare_sweeps(measured_kr5(kSeenByTracker)));
  INFO(run.errors);
  CHECK(run.code == 0);
  CHECK_THAT(run.out, ContainsSubstring("the angles tell sweeps of single joints"));
  check_lengths(run.result);
}

TEST_CASE("a column's unit has to be one that the description or the plan gives the joint",
          "[identify_by_angles]") {
  const TemporaryFolder folder;
  IdentifyOptions options;
  std::string unit = "rad";
  std::string said = "(a3_rad): expected mm, as joint 3 is linear";
  SECTION("by a description") {
    options.robot = folder.write("scara.toml", kScara);
  }
  SECTION("by a plan") {
    options.plan = folder.write("plan.toml", kScaraPlan);
  }
  SECTION("which turns") {
    options.robot = kConfig / "robots/kr5_arc.toml";
    unit = "mm";
    said = "(a3_mm): expected an angle, as joint 3 turns";
  }
  options.points = {folder.write("points.csv", "t_s,x_mm,y_mm,z_mm,a1_rad,a2_rad,a3_" + unit +
                                                   ",a4_rad\n0,1,2,3,0.1,0.2,0.3,0.4\n")};
  std::ostringstream out;
  CHECK_THROWS_WITH(identify_points(options, out, out), ContainsSubstring(said));
}

TEST_CASE("angles that are missing in part of the lines are said to be", "[missing_angles]") {
  const TemporaryFolder folder;
  const auto measured = measured_kr5(kSeenByTracker);
  /// Without the angles of A4 to A6.
  const auto cut = [](std::string line) {
    for (int j = 0; j < 3; ++j) line.resize(line.rfind(','));
    return line + ",,,\n";
  };
  std::string text = points_header({.angles = true});
  std::string said = "9 of 12 points of points.csv have no angles of joints 4, 5, 6";
  SECTION("of static poses that are too few then") {
    for (std::size_t k = 0; k < 12; ++k) {
      const std::string line =
          points_lines({measured.sweeps[k % 6].samples[50 + 20 * k]}, {.angles = true});
      text += k < 3 ? line : cut(line);
    }
    const auto run = told_by_angles(folder, text, true);
    CHECK(run.code == 1);
    CHECK_THAT(run.errors, ContainsSubstring("3 poses give 9 numbers") && ContainsSubstring(said));
    CHECK(run.result["warnings"][0]["code"] == "angles_missing");
    CHECK_THAT(run.out, ContainsSubstring("points: " + said));
  }
  SECTION("of all static poses") {
    text += cut(points_lines({measured.sweeps[0].samples[0]}, {.angles = true}));
    CHECK_THROWS_WITH(told_by_angles(folder, text, true),
                      ContainsSubstring("no line holds a position and all angles: 1 of 1 point of "
                                        "points.csv have no angles of joints 4, 5, 6"));
  }
  SECTION("of a stream's second half") {
    const auto& stream = measured.stream;
    text = points_header({.times = true, .angles = true});
    for (std::size_t k = 0; k < stream.size(); ++k) {
      const std::string line = points_lines({stream[k]}, {.times = true, .angles = true});
      text += k < stream.size() / 2 ? line : cut(line);
    }
    const auto run = told_by_angles(folder, text);
    CHECK(run.result["warnings"][0]["code"] == "angles_missing");
    CHECK_THAT(run.out, ContainsSubstring("have no angles of joints 4, 5, 6"));
  }
}

TEST_CASE("static poses in any order stay poses", "[identify_by_angles]") {
  const TemporaryFolder folder;
  auto measured = measured_kr5(kSeenByTracker);
  // Of two sweeps a line each, in turn: from line to line two joints move.
  std::string text = points_header({.angles = true});
  for (std::size_t k = 0; k < 400; k += 20)
    for (const std::size_t sweep : {1U, 2U})
      text += points_lines({measured.sweeps[sweep].samples[k]}, {.angles = true});
  const auto run = told_by_angles(folder, text);
  CHECK(run.code == 1);
  CHECK_THAT(run.errors, ContainsSubstring("poses alone need a start"));
}

TEST_CASE("an angle that jumps by 360 degrees has not moved", "[identify_by_angles][long]") {
  const double least_deg = GENERATE(0, -180);
  const auto measured = printed_from(least_deg, measured_kr5(kSeenByTracker));
  const TemporaryFolder folder;
  std::string text;
  SECTION("in a stream") {
    text = points_header({.times = true, .angles = true}) +
           points_lines(measured.stream, {.times = true, .angles = true});
  }
  SECTION("in sweeps that name their joint") {
    text = listed_points(measured, {.angles = true, .more = "joint,"});
  }
  SECTION("where the angles tell the sweeps") {
    text = bare_sweeps(measured);
  }
  const auto run = told_by_angles(folder, text);
  INFO(run.out << run.errors);
  CHECK(run.code == 0);
  check_lengths(run.result);
  if (least_deg < 0) return;
  CHECK_THAT(run.out, ContainsSubstring("jump by 360 degrees"));
  CHECK(std::abs(run.result["home_deg"][1].get<double>() - -90) < 0.01);
}
