#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/commands/identify_command.hpp"
#include "daemon/commands/plan_command.hpp"
#include "daemon/points/csv_file.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/simulation/simulation.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;
namespace fs = std::filesystem;

namespace {

PlanOptions planned_poses(std::size_t count, const fs::path& output) {
  PlanOptions options;
  options.robot = kConfig / "robots/kr5_arc.toml";
  options.poses.count = count;
  options.poses.limits.device_mm = Eigen::Vector3d(3000, 1500, 800);
  options.poses.limits.cone_deg = 70;
  options.output = output;
  return options;
}

/// What a tracker of 0.02 mm sees of a built KR 5 at the poses of a table.
std::string filled_in(const std::string& table, std::uint32_t seed) {
  std::istringstream in(table);
  std::vector<std::vector<double>> angles;
  std::string text, line;
  while (std::getline(in, line)) {
    if (line.starts_with('#') || line.starts_with("pose")) continue;
    std::istringstream cells(line.substr(line.find(",,,,") + 4));
    angles.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');)
      angles.back().push_back(radians(std::stod(cell)));
  }
  simulation::World world;
  world.angles = world.placed = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  const simulation::Simulation built(simulation::built(simulation::kr5(), seed),
                                     simulation::Strokes(), world, seed);
  std::ostringstream out;
  out.precision(12);
  out << "pose,x_mm,y_mm,z_mm,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg\n";
  for (const auto& pose : built.poses_at(angles)) {
    out << pose.name;
    for (const double value : pose.sample.position_mm) out << ',' << value;
    for (std::size_t j = 0; j < 6; ++j) out << ',' << degrees(pose.sample.angles_rad[j]);
    out << '\n';
  }
  return out.str();
}

}  // namespace

TEST_CASE("Forty planned poses, measured, give the uncertainties that were promised",
          "[pose_planning][long]") {
  const TemporaryFolder folder;
  const auto options = planned_poses(40, folder / "poses");
  std::ostringstream out;
  REQUIRE(plan(options, out, out) == 0);
  CHECK_THAT(out.str(), ContainsSubstring("sweepd_poses.csv") && ContainsSubstring("at random"));
  CHECK_FALSE(fs::exists(folder / "poses/sweepd_poses.src"));
  const std::string table = content(folder / "poses/sweepd_poses.csv");
  PoseTask task = options.poses;
  const PosePlan promised = plan_poses(load_robot(options.robot), task);
  double squares = 0;
  int count = 0;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    IdentifyOptions identify;
    identify.points = {folder.write("measured.csv", filled_in(table, seed))};
    identify.robot = options.robot;
    identify.output = folder / "result";
    identify.quiet = true;
    REQUIRE(identify_points(identify, out) == 0);
    const auto json = nlohmann::json::parse(content(folder / "result/result.json"));
    CHECK(json["status"].get<std::string>() == "complete");
    for (std::size_t i = 0; i < 5; ++i)
      for (const auto& [name, number, unit] :
           {std::tuple{"a_sigma_mm", &identify::DhEstimate::a_mm, 1.0},
            std::tuple{"alpha_sigma_deg", &identify::DhEstimate::alpha_rad, degrees(1)}}) {
        const double ratio =
            json["dh"][i][name].get<double>() / (unit * (promised.outlook.dh[i].*number).sigma);
        CHECK(ratio < 1.4);
        squares += ratio * ratio;
        ++count;
      }
  }
  CHECK(std::sqrt(squares / count) < 1.15);
  CHECK(std::sqrt(squares / count) > 0.9);
}

TEST_CASE("A table of poses that nobody has filled in is refused with what to do",
          "[pose_planning]") {
  const TemporaryFolder folder;
  auto options = planned_poses(12, folder / "poses");
  options.poses.candidates = 100;
  options.name = "mine";
  std::ostringstream out;
  REQUIRE(plan(options, out, out) == 0);
  IdentifyOptions identify;
  identify.points = {folder / "poses/mine.csv"};
  identify.robot = options.robot;
  CHECK_THROWS_WITH(identify_points(identify, out), ContainsSubstring("fill in where"));
}

TEST_CASE("Poses with wrong options, or what KRL cannot say, leave no file",
          "[pose_planning][long]") {
  const TemporaryFolder folder;
  auto options = planned_poses(12, folder / "poses");
  options.poses.candidates = 100;
  std::ostringstream out;
  options.propose = true;
  CHECK_THROWS_WITH(plan(options, out, out), ContainsSubstring("--propose"));
  options.propose = false;
  options.krl = KrlDialect::krc4;
  options.poses.speed_deg_s = 1;
  CHECK_THROWS_AS(plan(options, out, out), ConfigError);
  options.poses.speed_deg_s = 20;
  options.name = "dwell_s";
  CHECK_THROWS_WITH(plan(options, out, out), ContainsSubstring("which KRL or the program uses"));
  CHECK_FALSE(fs::exists(folder / "poses"));
  options.name = "mine";
  REQUIRE(plan(options, out, out) == 0);
  CHECK(fs::exists(folder / "poses/mine.dat"));
}
