#include "daemon/commands/correct_command.hpp"

#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/commands/identify_command.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/simulation/simulation.hpp"

using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;
using namespace sweepd;
using namespace sweepd::test;
namespace fs = std::filesystem;

namespace {

constexpr const char* kTwoPoints =
    "DEFDAT P PUBLIC\r\n"
    "DECL E6AXIS XP1={A1 80.0,A2 -95.0,A3 100.0,A4 10.0,A5 70.0,A6 -20.0,E1 5.0}\r\n"
    "DECL E6AXIS XP2={A1 100.0,A2 -80.0,A3 80.0,A4 -30.0,A5 50.0,A6 40.0,E1 5.0}\r\n"
    "ENDDAT\r\n";

/// A result of a KR 5's poses, as a tracker saw them.
void identify_once(const TemporaryFolder& folder, const simulation::Robot& robot) {
  simulation::World world;
  world.angles = world.placed = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  const simulation::Simulation built(robot, {}, world, 3);
  std::ostringstream csv;
  csv.precision(12);
  csv << "pose,x_mm,y_mm,z_mm,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg\n";
  for (const auto& pose : built.poses(40)) {
    csv << pose.name.substr(5);
    for (const double value : pose.sample.position_mm) csv << ',' << value;
    for (std::size_t j = 0; j < 6; ++j) csv << ',' << pose.sample.angles_rad[j] / identify::kDegree;
    csv << '\n';
  }
  IdentifyOptions options;
  options.points = {folder.write("poses.csv", csv.str())};
  options.robot = kConfig / "robots/kr5_arc.toml";
  options.output = folder / "result";
  options.quiet = true;
  std::ostringstream out;
  REQUIRE(identify_points(options, out) == 0);
}

/// A copy of its own.
struct CorrectableFolder {
  TemporaryFolder folder;
  fs::path path = folder / "result";
  std::ostringstream out;

  CorrectableFolder() {
    static const TemporaryFolder first;
    if (!fs::exists(first / "result"))
      identify_once(first, simulation::built(simulation::kr5(), 3));
    fs::create_directory(path);
    for (const char* name : {"result.json", "poses.csv"})
      fs::copy_file(first / "result" / name, path / name);
  }

  CorrectOptions options(CorrectionLevel level) const {
    CorrectOptions of;
    of.result = path;
    of.level = level;
    of.flange = "{X 0,Y 0,Z 115,A 0,B 0,C 0}";
    return of;
  }
  Json json() const { return Json::parse(content(path / "correction.json")); }
  /// result.json with another value at its top.
  void change(const char* key, const Json& value) const {
    auto result = nlohmann::ordered_json::parse(content(path / "result.json"));
    result[key] = value;
    (void)folder.write("result/result.json", result.dump());
  }
};

}  // namespace

TEST_CASE("Each level says what is to be corrected, and by how much", "[correct_command][long]") {
  CorrectableFolder result;
  const auto run = [&](CorrectionLevel level) {
    result.out.str("");
    REQUIRE(correct(result.options(level), result.out) == 0);
    const auto json = result.json();
    CHECK(json["schema"].get<std::string>() == "sweepd.correction/1");
    CHECK(json["poses"].get<int>() == 40);
    return json;
  };
  const auto stored = Json::parse(content(result.path / "result.json"));
  const auto frames = run(CorrectionLevel::frames);
  CHECK_THAT(result.out.str(), ContainsSubstring("$BASE = {X ") && ContainsSubstring("$TOOL = "));
  CHECK(frames["numbers"].empty());
  // Over the workspace no better for these poses than what identify fitted to them, and hardly
  // worse.
  const double by_poses = stored["poses"]["levels"][0]["rms_mm"].get<double>();
  CHECK(frames["left"]["corrected"]["rms_mm"].get<double>() >= by_poses);
  CHECK(frames["left"]["corrected"]["rms_mm"].get<double>() < 1.15 * by_poses);
  CHECK(frames["frames"]["base"]["determined"].get<bool>());
  // The flange is 115 mm in front of the last row's frame.
  CHECK(frames["frames"]["tools"][0]["position_mm"][2].get<double>() == Approx(100).margin(3));

  const auto zeros = run(CorrectionLevel::mastering);
  REQUIRE(zeros["numbers"].size() == 6);
  CHECK(zeros["numbers"][0]["verdict"].get<std::string>() == "inseparable");
  CHECK(zeros["numbers"][0]["offset"].is_null());
  CHECK_THAT(result.out.str(), ContainsSubstring("leave: not told from base, tool or others") &&
                                   ContainsSubstring("so it is not where the joint stands"));
  const double left = zeros["left"]["corrected"]["rms_mm"].get<double>();
  CHECK(left <= zeros["left"]["frames"]["rms_mm"].get<double>());

  const auto data = run(CorrectionLevel::machine_data);
  CHECK(data["left"]["corrected"]["rms_mm"].get<double>() < left);
  CHECK(data["unheld"]["rms_mm"].get<double>() > 0.02);
  CHECK_THAT(result.out.str(), ContainsSubstring("Only KUKA's service") &&
                                   !ContainsSubstring("where the joint stands"));
}

TEST_CASE("An arm as specified needs no mastering", "[correct_command][long]") {
  const TemporaryFolder folder;
  identify_once(folder, simulation::kr5());
  CorrectOptions options;
  options.result = folder / "result";
  options.level = CorrectionLevel::mastering;
  std::ostringstream out;
  REQUIRE(correct(options, out) == 0);
  CHECK_THAT(out.str(), ContainsSubstring("Nothing. No zero is seen to be off.") &&
                            !ContainsSubstring("master anew") &&
                            !ContainsSubstring("are named   "));
}

TEST_CASE("A program's points are corrected into another file", "[correct_command][long]") {
  CorrectableFolder result;
  auto options = result.options(CorrectionLevel::targets);
  options.program = result.folder.write("P.dat", kTwoPoints);
  options.write = result.folder / "P2.dat";
  REQUIRE(correct(options, result.out) == 0);
  CHECK(content(*options.program) == kTwoPoints);
  const auto corrected = content(*options.write);
  CHECK(corrected != kTwoPoints);
  CHECK_THAT(corrected, ContainsSubstring(",E1 5.0}\r\n"));
  const auto json = result.json();
  REQUIRE(json["points"].size() == 2);
  CHECK(json["points"][0]["shift_mm"].get<double>() > 0.05);
  CHECK(json["points"][0]["shift_mm"].get<double>() < 3);
  CHECK(json["points"][0]["expected_mm"].get<double>() < 0.08);
  CHECK(correct(options, result.out) == 0);  // the same again

  (void)result.folder.write("P2.dat", "somebody's");
  CHECK_THROWS_WITH(correct(options, result.out), ContainsSubstring("is not overwritten"));
  CHECK(content(*options.write) == "somebody's");
  options.force = true;
  CHECK(correct(options, result.out) == 0);
  options.write = options.program;
  CHECK_THROWS_WITH(correct(options, result.out), ContainsSubstring("this command reads it"));
  CHECK(content(*options.program) == kTwoPoints);
  options.write = result.folder / "." / "P2.dat";
  options.output = result.folder / "P2.dat";
  CHECK_THROWS_WITH(correct(options, result.out), ContainsSubstring("name one file"));
}

TEST_CASE("Options that do not go together, and programs that are none, are refused",
          "[correct_command][long]") {
  CorrectableFolder result;
  auto options = result.options(CorrectionLevel::targets);
  CHECK_THROWS_AS(correct(options, result.out), std::invalid_argument);
  options.program = result.folder / "missing.dat";
  options.write = result.folder / "P2.dat";
  CHECK_THROWS_WITH(correct(options, result.out),
                    ContainsSubstring("missing.dat: cannot be read: No such file or directory: "));
  options.program = result.folder.write("P.dat", "DECL E6POS XP1={X 1");
  CHECK_THROWS_WITH(correct(options, result.out), ContainsSubstring("P.dat line 1: the braces"));
  options.program = result.folder.write("P.dat", "DEFDAT P\nENDDAT\n");
  CHECK_THROWS_WITH(correct(options, result.out), ContainsSubstring("P.dat gives no point of "));
  CHECK_FALSE(fs::exists(*options.write));
  CHECK_FALSE(fs::exists(result.path / "correction.json"));
  options.level = CorrectionLevel::frames;
  CHECK_THROWS_AS(correct(options, result.out), std::invalid_argument);
  CHECK_THROWS_WITH(correct(options, result.out), ContainsSubstring("need --level targets: "));
  options = result.options(CorrectionLevel::frames);
  options.flange = "{X 0}";
  CHECK_THROWS_AS(correct(options, result.out), std::invalid_argument);
}

TEST_CASE("Results that nothing is corrected by are refused with the reason",
          "[correct_command][long]") {
  CorrectableFolder result;
  const auto options = result.options(CorrectionLevel::mastering);
  const auto refused = [&](const char* why) {
    CHECK_THROWS_WITH(correct(options, result.out), ContainsSubstring(why));
  };
  const auto whole = Json::parse(content(result.path / "result.json"));
  result.change("status", "doubtful");
  refused("is doubtful");
  result.change("status", "complete");
  result.change("describes", "controller_model");
  refused("controller's own model");
  result.change("describes", "arm");
  auto poses = whole["poses"];
  poses["levels"] = Json::array();
  result.change("poses", poses);
  refused("has no specified table");
  poses = whole["poses"];
  poses["model"]["axes"] = 1;
  result.change("poses", poses);
  refused("not as sweepd writes it");
  result.change("poses", whole["poses"]);
  CHECK(correct(options, result.out) == 0);
  auto joints = whole["joints"];
  joints[5]["axis"] = nullptr;
  result.change("joints", joints);
  auto targets = options;
  targets.level = CorrectionLevel::targets;
  targets.program = result.folder.write("P.dat", kTwoPoints);
  targets.write = result.folder / "P2.dat";
  CHECK_THROWS_WITH(correct(targets, result.out), ContainsSubstring("axes of all joints (6"));
  (void)result.folder.write("result/poses.csv",
                            "pose,x_mm,y_mm,z_mm,a1_deg,a2_deg,a3_deg,a4_deg,a5_"
                            "deg,a6_deg\n1,1,2,3,0,0,0,0,0,0\n");
  refused("is not that of the result.json");
}
