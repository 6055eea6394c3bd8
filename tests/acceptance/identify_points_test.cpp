// Files of other devices as they come, through the command that a user types.

#include <array>
#include <cmath>
#include <iostream>
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/commands/identify_command.hpp"
#include "tests/acceptance/acceptance.hpp"
#include "tests/catch.hpp"

using namespace acceptance;

namespace {

nlohmann::json identified(sweepd::IdentifyOptions options, std::ostringstream& report) {
  const TemporaryFolder folder;
  options.output = folder / "result";
  CHECK(sweepd::identify_points(options, report) == 0);
  std::cout << report.str() << '\n';
  return nlohmann::json::parse(text_of(*options.output / "result.json"));
}

}  // namespace

TEST_CASE("The seven logs of a real arm are one arm of seven joints", "[identify_points]") {
  const auto folder = real_data("sweep-logs");
  if (!folder) return;
  sweepd::IdentifyOptions options;
  for (int joint = 1; joint <= 7; ++joint)
    options.points.push_back(*folder / ("sawyer1-joint" + std::to_string(joint) + ".csv"));
  options.columns = "t_s,x_m,y_m,z_m,qx,qy,qz,qw";
  options.per_joint = true;
  std::ostringstream report;
  const auto result = identified(options, report);
  CHECK(result["status"] == "complete");
  REQUIRE(result["joints"].size() == 7);
  for (const auto& joint : result["joints"]) {
    CHECK(joint["sweeps"].size() == 1);
    CHECK(joint["circle"]["arc_deg"].get<double>() == Approx(140).margin(1));
  }
  // The arm as its maker publishes it: a1 81 mm, b3 400 mm, b5 400 mm, all twists right angles.
  const auto& dh = result["dh"];
  CHECK(std::abs(dh[0]["a_mm"].get<double>()) == Approx(81).margin(2));
  CHECK(std::abs(dh[2]["b_mm"].get<double>()) == Approx(400).margin(2));
  CHECK(std::abs(dh[4]["b_mm"].get<double>()) == Approx(400).margin(2));
  for (std::size_t j = 0; j < 6; ++j)
    CHECK(std::abs(dh[j]["alpha_deg"].get<double>()) == Approx(90).margin(0.5));
}

TEST_CASE("The rotary joint and the three slides of a positioning table are identified from points",
          "[identify_points]") {
  const auto folder = real_data("positioning-table");
  if (!folder) return;
  sweepd::IdentifyOptions options;
  options.points = {*folder / "sscanss2-table.txt"};
  options.columns = "joint,x_mm,y_mm,z_mm,-,-,-";
  std::ostringstream report;
  const auto result = identified(options, report);
  CHECK(result["status"] == "complete");
  CHECK_THAT(report.str(), Catch::Matchers::ContainsSubstring("44 in 4 sweeps of 1 file"));
  const auto& joints = result["joints"];
  REQUIRE(joints.size() == 4);
  CHECK(joints[1]["circle"]["radius_mm"].get<double>() == Approx(53.606).margin(0.0005));
  CHECK(joints[1]["circle"]["plane_rms_mm"].get<double>() == Approx(0.0049).margin(5e-5));
  CHECK(joints[1]["circle"]["radial_rms_mm"].get<double>() == Approx(0.0169).margin(5e-5));
  CHECK(joints[1].contains("axis"));
  // As the encoders say, which are not read. The last point of joint 1, at 500 mm, is an outlier.
  const std::array<std::pair<std::size_t, double>, 3> ways{{{0, 450}, {2, 400}, {3, 400}}};
  for (const auto& [j, way_mm] : ways) {
    CHECK(joints[j]["type"] == "linear");
    CHECK(joints[j].contains("axis"));
    CHECK(joints[j]["line"]["length_mm"].get<double>() == Approx(way_mm).margin(0.3));
  }
}
