#include "daemon/commands/validate_command.hpp"

#include <fstream>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "daemon/commands/identify_command.hpp"
#include "daemon/points/csv_file.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/results/poses_json.hpp"
#include "daemon/results/validation.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/identify/poses/simulated_poses.hpp"
#include "tests/simulation/simulation.hpp"

using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;
using namespace sweepd;
using namespace sweepd::test;
namespace fs = std::filesystem;

namespace {

/// A built KR 5 by its own home, seen by a tracker.
simulation::Simulation built_kr5(std::uint32_t seed) {
  simulation::World world;
  world.angles = world.placed = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  simulation::Strokes strokes;
  strokes.samples = 20;
  return {simulation::built(simulation::kr5(), seed), strokes, world, seed};
}

std::string lines_of(const std::vector<identify::Pose>& poses, std::size_t from, std::size_t to) {
  std::ostringstream text;
  text.precision(12);
  text << "pose,x_mm,y_mm,z_mm,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg\n";
  for (std::size_t i = from; i < to; ++i) {
    text << i;
    for (const double value : poses[i].sample.position_mm) text << ',' << value;
    for (std::size_t j = 0; j < 6; ++j)
      text << ',' << poses[i].sample.angles_rad[j] / identify::kDegree;
    text << '\n';
  }
  return text.str();
}

IdentifyOptions of_poses(const fs::path& file, const fs::path& output) {
  IdentifyOptions options;
  options.points = {file};
  options.robot = kConfig / "robots/kr5_arc.toml";
  options.output = output;
  options.quiet = true;
  return options;
}

}  // namespace

TEST_CASE("Poses that were kept back judge a result, and used ones are refused",
          "[validate_command][long]") {
  const TemporaryFolder folder;
  const auto poses = built_kr5(3).poses(140);
  const auto fit = folder.write("fit.csv", lines_of(poses, 0, 60));
  const auto held = folder.write("held.csv", lines_of(poses, 60, 140));
  const auto result = folder / "result";
  std::ostringstream out;
  REQUIRE(identify_points(of_poses(fit, result), out) == 0);
  const auto json = Json::parse(content(result / "result.json"));
  CHECK(json["status"].get<std::string>() == "complete");
  CHECK(json["estimator"].get<std::string>() == "poses");
  CHECK(json["describes"].get<std::string>() == "arm");
  CHECK(json["source"]["poses"].get<int>() == 60);
  CHECK(json["poses"]["count"].get<int>() == 60);
  CHECK_THAT(content(result / "report.txt"), ContainsSubstring("60 static poses"));
  CHECK_THAT(json["explanation"].get<std::string>(),
             ContainsSubstring("a length of 1 m is off by"));
  CHECK_THAT(content(result / "report.html"), ContainsSubstring("a length of 1 m is off by"));
  CHECK(fs::exists(result / "robot.urdf"));

  ValidateOptions options;
  options.result = result;
  options.points = {held};
  CHECK(validate(options, out) == 0);
  const auto found = Json::parse(content(result / "validation.json"));
  CHECK(found["schema"].get<std::string>() == "sweepd.validation/1");
  CHECK(found["count"].get<int>() == 80);
  CHECK(found["mean_mm"].get<double>() < 0.06);
  CHECK(found["inside_95"].get<int>() >= 70);
  REQUIRE(found["levels"].size() == 4);
  for (std::size_t k = 1; k < 4; ++k)
    CHECK(found["levels"][k]["mean_mm"].get<double>() <
          found["levels"][k - 1]["mean_mm"].get<double>());
  CHECK(validate(options, out) == 0);  // over its own file
  const std::string table = content(result / "displacement.csv");
  CHECK(table.starts_with("slice,x_mm,y_mm,z_mm,dx_mm,dy_mm,dz_mm,size_mm,band95_mm\n"));
  for (const char* slice : {"x", "y", "z"}) {
    CHECK_THAT(table, ContainsSubstring(std::string("\n") + slice + ","));
    const std::string svg = content(result / ("displacement-" + std::string(slice) + ".svg"));
    pugi::xml_document document;
    REQUIRE(document.load_string(svg.c_str()));
    CHECK(document.child("svg").select_nodes("//rect").size() > 100);
    std::set<std::string> names;  // pugixml takes one twice, strict readers do not
    for (const auto& attribute : document.child("svg").attributes())
      CHECK(names.insert(attribute.name()).second);
  }
  CHECK_THAT(
      content(result / "report.html"),
      ContainsSubstring("From the specification to the arm that was identified") &&
          ContainsSubstring("mm of the robot's base. The slices go through the target at home."));

  options.points = {held, fit};
  CHECK_THROWS_WITH(validate(options, out),
                    ContainsSubstring("fit.csv line 2") && ContainsSubstring("made of this pose"));

  options.points = {held};
  options.result = result / "result.json";
  auto edited = Json::parse(content(options.result));
  edited["status"] = "doubtful";
  const auto says = [&](const std::string& reason, const std::string& begin) {
    edited["reason"] = reason;
    std::ofstream(options.result) << edited.dump(2);
    out.str("");
    CHECK(validate(options, out) == 0);
    CHECK_THAT(out.str(), Catch::Matchers::StartsWith(begin));
  };
  says("the device was moved", "The result is doubtful: the device was moved.\n");
  says("are the positions in metres?", "The result is doubtful: are the positions in metres?\n");
  edited["schema"] = "sweepd.result/9";
  std::ofstream(options.result) << edited.dump(2);
  CHECK_THROWS_WITH(validate(options, out), ContainsSubstring("sweepd.result/9"));

  REQUIRE(identify_points(of_poses(fit, result), out) == 0);
  for (const char* of_the_old : {"validation.json", "displacement-x.svg"})
    CHECK_FALSE(fs::exists(result / of_the_old));
}

TEST_CASE("A result of joints that play predicts poses of which nobody knows how they came to rest",
          "[validate_command][long]") {
  const auto built = built_kr5(4);
  auto poses = simulation::robots::played(built.poses(160), 6, 15 * identify::kArcsec, 4);
  const std::vector<identify::Pose> used(poses.begin(), poses.begin() + 60);
  std::vector<identify::Pose> kept(poses.begin() + 60, poses.end());
  for (auto& pose : kept) pose.senses = {};
  Outcome outcome;
  outcome.identification = identify::identify({}, built.campaign(), used);
  REQUIRE(outcome.identification.poses);
  CHECK(validated(pose_predictor(poses_json(outcome)), kept).inside() > 88);
}

TEST_CASE("poses.csv of a result gives the same result again", "[validate_command][long]") {
  const TemporaryFolder folder;
  const auto poses = built_kr5(4).poses(50);
  std::ostringstream out;
  const auto first = folder / "first", again = folder / "again";
  REQUIRE(identify_points(of_poses(folder.write("fit.csv", lines_of(poses, 0, 50)), first), out) ==
          0);
  REQUIRE(identify_points(of_poses(first / "poses.csv", again), out) == 0);
  const auto a = Json::parse(content(first / "result.json"))["dh"];
  const auto b = Json::parse(content(again / "result.json"))["dh"];
  for (std::size_t j = 0; j < 5; ++j)
    CHECK(a[j]["a_mm"].get<double>() == Approx(b[j]["a_mm"].get<double>()).margin(1e-4));
}

TEST_CASE("A result without poses, another file, and poses without angles are refused",
          "[validate_command]") {
  const TemporaryFolder folder;
  std::ostringstream out;
  ValidateOptions options;
  options.result = folder.path();
  options.points = {folder.write("held.csv", lines_of(built_kr5(5).poses(30), 0, 30))};
  CHECK_THROWS_WITH(validate(options, out),
                    ContainsSubstring("cannot be read: No such file or directory: "));
  (void)folder.write("result.json", R"({"schema":"sweepd.result/1"})");
  CHECK_THROWS_WITH(validate(options, out), ContainsSubstring("not made of static poses"));
  (void)folder.write("result.json",
                     R"({"schema":"sweepd.result/1","poses":{"model":{"axes":[1]}}})");
  CHECK_THROWS_WITH(validate(options, out), ContainsSubstring("not as sweepd writes it"));
  (void)folder.write("result.json", "{");
  CHECK_THROWS_WITH(validate(options, out), ContainsSubstring("holds no result of sweepd"));
  auto wanted =
      of_poses(folder.write("bare.csv", "pose,x_mm,y_mm,z_mm\n1,2,3,4\n"), folder / "none");
  CHECK_THROWS_WITH(identify_points(wanted, out), ContainsSubstring("joint angles"));
}

TEST_CASE("Too few static poses are told as such, and no sweep is missed", "[validate_command]") {
  const TemporaryFolder folder;
  std::ostringstream out;
  const auto few = folder.write("few.csv", lines_of(built_kr5(6).poses(30), 0, 4));
  CHECK(identify_points(of_poses(few, folder / "result"), out) == 1);
  const auto warnings = Json::parse(content(folder / "result/result.json"))["warnings"];
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0]["code"].get<std::string>() == "poses_not_used");
}

TEST_CASE("A pose visited again tells accuracy and repeatability", "[validate_command][long]") {
  const TemporaryFolder folder;
  const auto built = built_kr5(6);
  auto poses = built.poses(70);
  for (std::size_t i = 61; i < 66; ++i) {
    poses[i] = poses[60];
    poses[i].sample.position_mm.x() += 0.05 * static_cast<double>(i - 60);
  }
  std::ostringstream out;
  const auto result = folder / "result";
  REQUIRE(identify_points(of_poses(folder.write("fit.csv", lines_of(poses, 0, 60)), result), out) ==
          0);
  ValidateOptions options;
  options.result = result;
  options.points = {folder.write("held.csv", lines_of(poses, 60, 70))};
  REQUIRE(validate(options, out) == 0);
  const auto visits = Json::parse(content(result / "validation.json"))["visits"];
  REQUIRE(visits.size() == 1);
  CHECK(visits[0]["count"].get<int>() == 6);
  CHECK(visits[0]["accuracy_mm"].get<double>() == Approx(0.125).margin(0.06));
  // Distances 0.125, 0.075, 0.025 mm from the middle, each twice: mean 0.075, S 0.0447.
  CHECK(visits[0]["repeatability_mm"].get<double>() == Approx(0.075 + 3 * 0.0447).margin(0.002));
}

TEST_CASE("Poses of a device that was set up elsewhere are judged in the frame that fits them",
          "[validate_command][long]") {
  const TemporaryFolder folder;
  auto poses = built_kr5(3).poses(90);
  const auto fit = folder.write("fit.csv", lines_of(poses, 0, 60));
  const auto kept = folder.write("kept.csv", lines_of(poses, 60, 90));
  const Eigen::AngleAxisd turn(1, Eigen::Vector3d(1, 2, 3).normalized());
  auto nudged_poses = poses;
  for (auto& pose : nudged_poses) pose.sample.position_mm += Eigen::Vector3d(0.08, -0.08, 0.08);
  const auto nudged = folder.write("nudged.csv", lines_of(nudged_poses, 60, 90));
  auto changed_poses = poses;  // a joint has lost its mastering
  for (auto& pose : changed_poses) pose.sample.angles_rad[2] += 0.05 * identify::kDegree;
  const auto changed = folder.write("changed.csv", lines_of(changed_poses, 60, 90));
  for (auto& pose : poses)
    pose.sample.position_mm = turn * pose.sample.position_mm + Eigen::Vector3d(500, -3000, 200);
  const auto elsewhere = folder.write("elsewhere.csv", lines_of(poses, 60, 90));
  const auto few = folder.write("few.csv", lines_of(poses, 60, 63));
  ValidateOptions options;
  options.result = folder / "result";
  std::ostringstream out;
  REQUIRE(identify_points(of_poses(fit, options.result), out) == 0);
  const auto judge = [&](const fs::path& file) {
    options.points = {file};
    out.str("");
    CHECK(validate(options, out) == 0);
    return Json::parse(content(options.result / "validation.json"));
  };
  const auto here = judge(kept);
  CHECK_FALSE(here.contains("frame"));
  CHECK_THAT(out.str(), !ContainsSubstring("frame") && !ContainsSubstring("verdict"));
  CHECK(judge(changed)["inside_95"].get<int>() < 15);
  CHECK_THAT(out.str(), ContainsSubstring("verdict     These poses contradict the result"));
  const auto there = judge(elsewhere);
  CHECK(there["mean_mm"].get<double>() > 1000);
  REQUIRE(there.contains("frame"));
  CHECK_THAT(out.str(), ContainsSubstring("in another frame"));
  // One radian, and what is left is that of the same poses, less what six numbers take up.
  CHECK(there["frame"]["turned_deg"].get<double>() == Approx(57.296).margin(0.01));
  CHECK(there["frame"]["mean_mm"].get<double>() ==
        Approx(here["mean_mm"].get<double>()).epsilon(0.3));
  CHECK(there["frame"]["inside_95"].get<int>() >= 25);
  CHECK_THAT(out.str(), !ContainsSubstring("verdict"));
  CHECK_FALSE(judge(few).contains("frame"));
  CHECK_THAT(out.str(), ContainsSubstring("lie far off"));
  // As little as 0.14 mm, seven times the noise.
  const auto near = judge(nudged);
  CHECK(near["mean_mm"].get<double>() < 0.2);
  REQUIRE(near.contains("frame"));
  CHECK(near["frame"]["moved_mm"].get<double>() == Approx(0.1386).margin(0.03));
}

TEST_CASE("What result.json says of the model's uncertainty has what was moved amid the poses",
          "[validate_command][long]") {
  const auto built = built_kr5(4);
  auto poses = built.poses(50);
  for (std::size_t i = 35; i < poses.size(); ++i) poses[i].sample.position_mm.x() += 0.2;
  Outcome outcome;
  outcome.identification = identify::identify({}, built.campaign(), poses);
  const auto& found = outcome.identification.poses;
  REQUIRE(found);
  CHECK(found->step.seen);
  const auto json = poses_json(outcome);
  CHECK(json["step"]["of"] == "device");
  CHECK(json["step"]["from"].get<double>() == Approx(36).margin(1));
  const auto told = pose_predictor(json).fit.covariance;
  const Eigen::MatrixXd whole = found->whole_covariance().topLeftCorner(told.rows(), told.cols());
  CHECK((told - whole).norm() < 1e-9 * whole.norm());
  const Eigen::MatrixXd by_fit = found->fit.whole_covariance();
  CHECK(whole.trace() > 2 * by_fit.topLeftCorner(told.rows(), told.cols()).trace());
}
