// A KR 5 arc from the files that measuring devices leave, without an option that says whose they
// are.

#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/commands/identify_command.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/devices/device_files.hpp"
#include "tests/daemon/point_files.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using Json = nlohmann::json;
using namespace sweepd;
using namespace sweepd::test;

namespace {

/// One target, as a marker and as a body that does not turn.
Take take_of(const std::vector<identify::Sample>& samples) {
  Take take;
  take.rate_hz = 125;
  take.names = {"Tool"};
  const double begin_s = samples.front().time_s;
  for (std::size_t i = 0; i < samples.size(); i += 2) {
    const auto& sample = samples[i];
    Frame frame;
    frame.time_s = sample.time_s - begin_s;
    frame.body_mm = sample.position_mm;
    frame.markers_mm = {sample.position_mm};
    take.frames.push_back(frame);
  }
  return take;
}

/// Five sigma are not passed by chance.
void check_kr5(const Json& result) {
  INFO(result.dump(1));
  CHECK(result["status"] == Json("complete"));
  std::size_t compared = 0;
  for (std::size_t j = 0; j < 5; ++j)
    for (const std::string name : {"b_mm", "a_mm", "alpha_deg"}) {
      const auto& difference = result["difference"][j][name];
      if (difference.is_null()) continue;
      const std::string sigma = std::string(name).insert(name.find('_'), "_sigma");
      // The last printed decimal is an error too.
      CHECK(std::abs(difference.get<double>()) <= 5 * result["dh"][j][sigma].get<double>() + 2e-6);
      ++compared;
    }
  CHECK(compared == 14);  // b of the parallel pair is by convention
}

}  // namespace

TEST_CASE("a KR 5 arc is identified from the file of each device, as it is",
          "[identify_command][long]") {
  const TemporaryFolder folder;
  const Measured measured = measured_kr5({.position_mm = 0.02, .seed = 5});
  for (const auto& kind : device_files()) {
    INFO(kind.format << (kind.of == Of::body ? ", body" : ", marker"));
    IdentifyOptions options;
    options.robot = kConfig / "robots/kr5_arc.toml";
    options.plan = kConfig / "plans/kr5_arc_90deg.toml";
    options.device_frame = false;
    options.output = folder / "result";
    options.force = true;
    if (kind.has_times) {
      options.points = {folder.write("take.csv", kind.write(take_of(measured.stream)))};
    } else {
      options.per_joint = true;
      for (const auto& sweep : measured.sweeps)
        options.points.push_back(folder.write("joint" + std::to_string(sweep.joint) + ".txt",
                                              kind.write(take_of(sweep.samples))));
    }
    std::ostringstream said;
    CHECK(identify_points(options, said) == 0);
    check_kr5(Json::parse(content(folder / "result/result.json")));
    const auto run = Json::parse(content(folder / "result/run.json"));
    REQUIRE(run["formats"].size() == options.points.size());
    const auto title = run["formats"][options.points.front().string()].get<std::string>();
    CHECK_THAT(said.str(), StartsWith("points: " + title));
    CHECK_THAT(said.str(), ContainsSubstring("\n" + content(folder / "result/report.txt")));
  }
}

TEST_CASE("groups that are named as joints need no option, and others are told what to do",
          "[identify_command]") {
  const TemporaryFolder folder;
  std::string text = "// SpatialAnalyzer 2023.1\n// Units: mm\n", other = text;
  for (const auto& sweep : measured_kr5({.position_mm = 0.02, .seed = 5}).sweeps)
    for (std::size_t i = 0; i < sweep.samples.size(); i += 20) {
      const auto xyz = xyz_text(sweep.samples[i].position_mm, 1, " ");
      text += fmt::format("A Joint{} p{} {}\n", sweep.joint, i, xyz);
      other += fmt::format("A Scan{} p{} {}\n", sweep.joint, i, xyz);
    }
  IdentifyOptions options;
  options.robot = kConfig / "robots/kr5_arc.toml";
  options.plan = kConfig / "plans/kr5_arc_90deg.toml";
  options.device_frame = false;
  options.output = folder / "result";
  options.points = {folder.write("points.txt", text)};
  std::ostringstream said;
  CHECK(identify_points(options, said) == 0);
  check_kr5(Json::parse(content(folder / "result/result.json")));

  options.points = {folder.write("points.txt", other)};
  CHECK_THROWS_WITH(identify_points(options, said),
                    ContainsSubstring("expected times of a stream, or groups that are named as "
                                      "joints (Joint 1), found neither"));
}

TEST_CASE("the formats are listed, and one that does not fit is an error", "[identify_command]") {
  const TemporaryFolder folder;
  IdentifyOptions options;
  options.list_formats = true;
  std::ostringstream said;
  CHECK(identify_points(options, said) == 0);
  CHECK_THAT(said.str(), ContainsSubstring("motive ") && ContainsSubstring("Qualisys QTM TSV") &&
                             ContainsSubstring("sweepd "));
  options.list_formats = false;
  options.format = "motive";
  options.axes = "axes.csv";
  CHECK_THROWS_AS(identify_points(options, said), std::invalid_argument);
  options.axes.reset();
  options.points = {folder.write("points.csv", "t_s,x_mm,y_mm,z_mm\n0,1,2,3\n")};
  CHECK_THROWS_WITH(identify_points(options, said),
                    ContainsSubstring("line 1: expected Format Version, as Motive writes it"));
}
