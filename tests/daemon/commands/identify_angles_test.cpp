#include <algorithm>
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/commands/identify_command.hpp"
#include "daemon/devices/device_text.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/device_play.hpp"
#include "tests/daemon/simulations.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;
using namespace sweepd;
using namespace sweepd::test;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

fs::path trace_in(const TemporaryFolder& folder, const fs::path& plan = kPlan) {
  auto options = simulation_of(plan);
  options.write = folder / "trace.pcap";
  options.force = true;
  REQUIRE(run(options).code == 0);
  return *options.write;
}

struct Result {
  int code = 0;
  std::string report;
  Json json;
};

Result identified(const TemporaryFolder& folder, const std::string& device_file) {
  IdentifyOptions options;
  options.points = {folder.write("take.csv", device_file)};
  options.angles = {folder / "trace.pcap"};
  options.robot = kRobot;
  options.output = folder / "result";
  options.force = true;
  std::ostringstream report;
  Result result;
  result.code = identify_points(options, report);
  result.report = report.str();
  result.json = Json::parse(content(folder / "result" / "result.json"));
  return result;
}

}  // namespace

TEST_CASE("A device's file without angles is identified with those of a trace",
          "[identify_angles][long]") {
  const TemporaryFolder folder;
  trace_in(folder);
  constexpr double kWrongFrameRate = 1e-3;
  for (const auto& [ahead_s, rate] : {std::pair{0.25, 4e-5}, std::pair{-3.7, 4e-5},
                                      std::pair{1.7e9, 4e-5}, std::pair{0.25, kWrongFrameRate}}) {
    DevicePlay device;
    device.ahead_s = ahead_s;
    device.rate = rate;
    device.jitter_s = 0.005;
    device.loss = 0.02;
    const auto result = identified(folder, device_file(device_play(kRobot, kPlan, device)));
    INFO(result.report);
    CHECK(result.code == 0);
    CHECK(result.json["status"] == Json("complete"));
    CHECK(result.json["describes"] == Json("arm"));
    CHECK(result.json["estimator"] == Json("poses"));
    const Json& clocks = result.json["clocks"];
    const double at_s = clocks["at_s"];
    CHECK_THAT(clocks["ahead_s"].get<double>() - ahead_s - rate * at_s,
               WithinAbs(0, 4e-3 * clocks["sigma_ms"].get<double>()));
    CHECK(clocks["sigma_ms"].get<double>() < 0.2);
    CHECK_THAT(clocks["rate_ppm"].get<double>(),
               WithinAbs(1e6 * rate, 4 * clocks["rate_sigma_ppm"].get<double>()));
    CHECK(clocks["rests"].get<int>() > 15);
    const Json& warnings = result.json["warnings"];
    CHECK(std::any_of(warnings.begin(), warnings.end(), [](const Json& warning) {
            return warning["code"] == "frame_rate";
          }) == (rate == kWrongFrameRate));
    for (const Json& row : result.json["difference"])
      for (const char* number : {"a_mm", "alpha_deg"})
        if (row.contains(number) && row[number].is_number())
          CHECK_THAT(row[number].get<double>(), WithinAbs(0, 0.05));
    CHECK_THAT(result.report, ContainsSubstring("clocks      at "));
  }
}

TEST_CASE("A trace of other motion is refused, saying so", "[identify_angles]") {
  const TemporaryFolder folder;
  trace_in(folder, kConfig / "plans/kr5_arc_30deg.toml");
  const auto result = identified(folder, device_file(device_play(kRobot, kPlan, {})));
  CHECK(result.code == 1);
  CHECK(result.json["status"] == Json("failed"));
  CHECK_THAT(result.json["reason"].get<std::string>(), ContainsSubstring("do not agree"));
}

TEST_CASE("Points that cannot be joined with angles are an error", "[identify_angles]") {
  const TemporaryFolder folder;
  trace_in(folder);
  CHECK_THROWS_WITH(identified(folder, "x_mm,y_mm,z_mm\n1,2,3\n"), ContainsSubstring("times"));
  CHECK_THROWS_WITH(identified(folder, "t_s,joint,x_mm,y_mm,z_mm\n1,1,1,2,3\n"),
                    ContainsSubstring("without joints and angles"));
  IdentifyOptions options;
  options.points = {folder / "take.csv"};
  options.angles = {folder / "trace.pcap"};
  options.per_joint = true;
  CHECK_THROWS_WITH(identify_points(options), ContainsSubstring("--angles"));
}
