#include "daemon/commands/replay_command.hpp"

#include <algorithm>
#include <optional>
#include <sstream>
#include <streambuf>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/commands/simulate_command.hpp"
#include "daemon/points/points_file.hpp"
#include "daemon/settings/toml_table.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;
using sweepd::replay;
using sweepd::ReplayOptions;
using namespace sweepd::test;
namespace fs = std::filesystem;

namespace {

struct Replayed {
  int code = 0;
  std::string report;
  std::string errors;
};

Replayed replayed(const ReplayOptions& options) {
  std::ostringstream report;
  std::ostringstream errors;
  const int code = replay(options, report, errors);
  return {code, report.str(), errors.str()};
}

ReplayOptions trace_options(const fs::path& trace, const fs::path& output) {
  ReplayOptions result;
  result.traces = {trace};
  result.config = kConfig / "sweepd.toml";
  result.output = output;
  return result;
}

void simulate(const fs::path& trace, sweepd::SimulateOptions simulated) {
  simulated.robot = kConfig / "robots/kr5_arc.toml";
  simulated.write = trace;
  simulated.quiet = true;
  std::ostringstream ignored;
  REQUIRE(sweepd::simulate(simulated, ignored, ignored) == 0);
}

void simulate(const fs::path& trace, const std::optional<fs::path>& ethernet_config = {}) {
  sweepd::SimulateOptions simulated;
  simulated.plan = kConfig / "plans/kr5_arc_30deg.toml";
  simulated.ethernet_config = ethernet_config;
  simulate(trace, simulated);
}

/// Each joint of the KR 5 there and back, over 78 degrees.
std::string plan_there_and_back(const std::string& speed_deg_s) {
  std::string plan =
      "home_deg = [90.0, -90.0, 90.0, 0.0, 90.0, 0.0]\npositioning_speed_deg_s = 60.0\n"
      "acceleration_deg_s2 = 200.0\ndwell_ms = 300\n";
  int joint = 0;
  for (const int home : {90, -90, 90, 0, 90, 0}) {
    ++joint;
    for (const int way : {-39, 39})
      plan += "[[sweep]]\njoint = " + std::to_string(joint) +
              "\nstart_deg = " + std::to_string(home + way) +
              ".0\nend_deg = " + std::to_string(home - way) + ".0\nspeed_deg_s = " + speed_deg_s +
              "\n";
  }
  return plan;
}

Json result_in(const fs::path& folder) {
  return Json::parse(content(folder / "result.json"));
}

std::string robot_table(const std::string& name, const std::string& port) {
  return "[[robot]]\nname = \"" + name + "\"\ndescription = \"" +
         (kConfig / "robots/kr5_arc.toml").string() + "\"\nlisten = \"0.0.0.0:" + port +
         "\"\noutput = \"out\"\n";
}

}  // namespace

TEST_CASE("Friction of each motor is found where telegrams have currents, and nothing where not",
          "[replay_command][long]") {
  const TemporaryFolder folder;
  simulate(folder / "with.pcap");
  REQUIRE(replayed(trace_options(folder / "with.pcap", folder / "with")).code == 0);
  const auto currents = result_in(folder / "with")["currents"];
  // What the simulated robot has, with noise of 0.05 A a telegram.
  const std::vector<double> friction{1.2, 1.5, 1.0, 0.5, 0.4, 0.3};
  REQUIRE(currents.size() == friction.size());
  for (std::size_t j = 0; j < friction.size(); ++j) {
    CHECK(currents[j]["friction_a"].get<double>() == Approx(friction[j]).margin(0.02));
    CHECK(currents[j]["scatter_a"].get<double>() < 0.1);
    CHECK(currents[j]["places"].get<int>() >= 4);
  }
  CHECK_THAT(content(folder / "with/report.html"),
             ContainsSubstring("Motor current over the angle"));
  CHECK_THAT(content(folder / "with/currents.csv"), ContainsSubstring("\n6,"));
  const auto samples = sweepd::PointsReader({}, 6).read(folder / "with/samples.csv", {});
  CHECK(samples.angles == 6);

  auto text = content(kConfig / "controller/krc4/sweepd_ethernet.xml");
  text.replace(text.find("DEF_MACur"), 9, "DEF_ESPos");
  simulate(folder / "without.pcap", folder.write("without.xml", text));
  REQUIRE(replayed(trace_options(folder / "without.pcap", folder / "without")).code == 0);
  CHECK_FALSE(result_in(folder / "without").contains("currents"));
  CHECK_FALSE(fs::exists(folder / "without/currents.csv"));
  CHECK_THAT(content(folder / "without/samples.csv"), !ContainsSubstring("current"));
  // Currents change nothing else.
  auto with = result_in(folder / "with");
  with.erase("currents");
  CHECK(with.dump() == result_in(folder / "without").dump());
}

TEST_CASE("signals that telegrams do not have are a warning of the result",
          "[replay_command][long]") {
  const TemporaryFolder folder;
  simulate(folder / "trace.pcap");
  auto options = trace_options(folder / "trace.pcap", folder / "out");
  const auto codes = [&] {
    std::vector<std::string> all;
    const Json result = result_in(folder / "out");
    for (const auto& warning : result["warnings"])
      all.push_back(warning["code"].get<std::string>());
    return all;
  };
  const auto names = [](const std::string& sixth) {
    return "[robot.signals]\nangles = [\"AIPos.A1\", \"AIPos.A2\", \"AIPos.A3\", \"AIPos.A4\", "
           "\"AIPos.A5\", \"" +
           sixth + "\"]\n";
  };
  options.config = folder.write("sweepd.toml", robot_table("kr5", "49152") + names("AIPos.A6"));
  static_cast<void>(replayed(options));
  CHECK(std::ranges::count(codes(), "missing_signals") == 0);
  options.config = folder.write("sweepd.toml", robot_table("kr5", "49152") + names("AIPos.A7"));
  INFO(replayed(options).errors);
  REQUIRE(std::ranges::count(codes(), "missing_signals") == 1);
  CHECK_THAT(content(folder / "out/result.json"),
             ContainsSubstring("the telegrams have no AIPos.A7: correct `signals`"));
}

TEST_CASE("angles that are even to the last digit tell no delay that grows, and accuse no gear",
          "[replay_command][long]") {
  const TemporaryFolder folder;
  for (const char* speed : {"12.3", "20.0", "21.7"}) {
    CAPTURE(speed);
    sweepd::SimulateOptions simulated;
    simulated.plan = folder.write("plan.toml", plan_there_and_back(speed));
    simulated.cycle_ms = 12;
    simulated.wobble_deg = 0;
    simulate(folder / "even.pcap", simulated);
    CHECK(replayed(trace_options(folder / "even.pcap", folder / "out")).code == 0);
    const auto result = result_in(folder / "out");
    CHECK(result["warnings"].empty());
    if (result.contains("delay")) CHECK(result["delay"]["corrected"] == false);
  }
}

TEST_CASE("two replays leave the same files, byte for byte", "[replay_command][long]") {
  const TemporaryFolder folder;
  const auto trace = folder / "trace.pcap";
  simulate(trace);
  const auto first = replayed(trace_options(trace, folder / "first"));
  const auto second = replayed(trace_options(trace, folder / "second/deeper"));
  CHECK(first.code == 0);
  CHECK(first.errors.empty());
  CHECK(first.report == second.report);
  CHECK(first.report == content(folder / "first/report.txt"));
  for (const char* name : {"result.json", "dh.csv", "sweeps.csv", "report.txt", "samples.csv"}) {
    INFO(name);
    CHECK_FALSE(content(folder / "first" / name).empty());
    CHECK(content(folder / "first" / name) == content(folder / "second/deeper" / name));
  }
  const auto result = result_in(folder / "first");
  CHECK(result["status"] == "complete");
  CHECK(result["robot"] == "kr5-arc");
  CHECK(result["source"]["kind"] == "trace");
  // Paths and the like are kept out of the result.
  CHECK_THAT(content(folder / "first/result.json"), !ContainsSubstring(folder.path().string()));
  CHECK_THAT(content(folder / "first/run.json"), ContainsSubstring(trace.string()));
  CHECK_FALSE(fs::exists(folder / "first/trace.pcap"));
}

TEST_CASE("a replay without an output folder leaves no files; a quiet one says nothing",
          "[replay_command][long]") {
  const TemporaryFolder folder;
  const auto trace = folder / "trace.pcap";
  simulate(trace);
  auto wanted = trace_options(trace, {});
  wanted.output.reset();
  CHECK_THAT(replayed(wanted).report, ContainsSubstring("complete"));
  wanted.quiet = true;
  const auto result = replayed(wanted);
  CHECK(result.code == 0);
  CHECK(result.report.empty());
  CHECK(result.errors.empty());
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("a capture in two pieces gives what the whole one gives", "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "whole.pcap").add_stroke(ipoc, 0, 60);
  {
    rsi::CaptureWriter first(folder / "trace.pcap");
    rsi::CaptureWriter second(folder / "trace-0002.pcap");
    rsi::CaptureReader whole(folder / "whole.pcap");
    for (int k = 0; const auto datagram = whole.next(); ++k)
      (k < 200 ? first : second).write(*datagram);
  }
  CHECK(replayed(trace_options(folder / "whole.pcap", folder / "whole")).code == 0);
  // As a shell puts "trace*.pcap".
  auto pieces = trace_options(folder / "trace-0002.pcap", folder / "pieces");
  pieces.traces.push_back(folder / "trace.pcap");
  CHECK(replayed(pieces).code == 0);
  for (const char* name : {"result.json", "samples.csv", "sweeps.csv"})
    CHECK(content(folder / "pieces" / name) == content(folder / "whole" / name));
}

TEST_CASE("a capture without RSI leaves a failed result with the reason, one sentence, and exit 1",
          "[replay_command]") {
  const TemporaryFolder folder;
  Capture(folder / "x.pcap").add("something else");
  const auto result = replayed(trace_options(folder / "x.pcap", folder / "out"));
  CHECK(result.code == 1);
  CHECK_THAT(result.errors, Catch::Matchers::StartsWith("sweepd: no RSI among "));
  CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
  CHECK(result_in(folder / "out")["status"] == "failed");
  CHECK(result_in(folder / "out")["reason"] == "no RSI telegrams in the capture");
  CHECK_THAT(result.report, ContainsSubstring("failed: no RSI telegrams in the capture"));
}

TEST_CASE("where the RSI that was asked for is not there, what is in the folder stays",
          "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "x.pcap").add_stroke(ipoc, 0, 60);
  auto wanted = trace_options(folder / "x.pcap", folder / "out");
  CHECK(replayed(wanted).code == 0);
  const auto before = content(folder / "out/result.json");
  wanted.filter.port = 1;
  const auto result = replayed(wanted);
  CHECK(result.code == 1);
  CHECK_THAT(result.errors, Catch::Matchers::StartsWith("sweepd: no RSI conversation on port 1, "));
  CHECK(result.report.empty());
  CHECK(content(folder / "out/result.json") == before);
}

TEST_CASE("a capture without RSI is no matter of the settings, however many robots they have",
          "[replay_command]") {
  const TemporaryFolder folder;
  Capture(folder / "x.pcap").add("something else");
  auto wanted = trace_options(folder / "x.pcap", folder / "out");
  wanted.config = folder.write("two.toml", robot_table("a", "1000") + robot_table("b", "2000"));
  CHECK(replayed(wanted).code == 1);
  CHECK(result_in(folder / "out")["status"] == "failed");
}

TEST_CASE("a capture in which no joint is swept is exit 1 with the reason", "[replay_command]") {
  const TemporaryFolder folder;
  Capture(folder / "x.pcap").add(telegram(4000, joint_1_at(0))).add(telegram(4004, joint_1_at(0)));
  const auto result = replayed(trace_options(folder / "x.pcap", folder / "out"));
  CHECK(result.code == 1);
  CHECK(result_in(folder / "out")["status"] == "failed");
  CHECK(result_in(folder / "out")["reason"] == "no sweep of a single joint was seen");
  CHECK(result_in(folder / "out")["source"]["telegrams"] == 2);
}

TEST_CASE("one joint of six is a partial result and exit 0", "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "x.pcap").add_stroke(ipoc, 0, 60);
  const auto result = replayed(trace_options(folder / "x.pcap", folder / "out"));
  CHECK(result.code == 0);
  CHECK(result_in(folder / "out")["status"] == "partial");
  CHECK_FALSE(result_in(folder / "out")["reason"].get<std::string>().empty());
}

TEST_CASE("an external axis that moved while joints were swept makes the result doubtful: exit 3",
          "[replay_command][long]") {
  const TemporaryFolder folder;
  auto file = content(kEthernet);
  const std::string position = "<ELEMENT TAG=\"DEF_RIst\"";
  REQUIRE(file.find(position) != std::string::npos);
  file.insert(file.find(position),
              "<ELEMENT TAG=\"DEF_EIPos\" TYPE=\"DOUBLE\" INDX=\"INTERNAL\"/>\n");
  const auto trace = folder / "trace.pcap";
  simulate(trace, folder.write("sweepd.xml", file));
  auto bytes = content(trace);
  const std::string still = "<EIPos E1=\"0.0000\"";
  const bool moves = GENERATE(false, true);
  std::size_t telegrams = 0;
  for (auto at = bytes.find(still); at != std::string::npos; at = bytes.find(still, at)) {
    // Where it stands is all the same; a second on, it stands elsewhere.
    const bool elsewhere = moves && telegrams++ / 250 % 2 == 1;
    bytes[at + still.find('0')] = elsewhere ? '7' : '5';
    ++at;
  }
  const auto changed = folder.write("changed.pcap", bytes);
  const auto run = replayed(trace_options(changed, folder / "out"));
  INFO(run.report << run.errors);
  const auto result = result_in(folder / "out");
  CHECK(run.code == (moves ? 3 : 0));
  CHECK(result["status"] == (moves ? "doubtful" : "complete"));
  if (!moves) return;
  CHECK(result["doubts"][0]["code"] == "external_axis_moved");
  // The reason stands before all numbers.
  CHECK(run.report.find("external axis") < run.report.find("theta"));
  for (const char* name : {"dh.csv", "sweeps.csv", "report.txt"})
    CHECK(fs::exists(folder / "out" / name));
}

TEST_CASE("of a capture that is cut off, what was read is used, and it is said",
          "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "x.pcap").add_stroke(ipoc, 0, 60).add(telegram(ipoc, joint_1_at(60)));
  fs::resize_file(folder / "x.pcap", fs::file_size(folder / "x.pcap") - 7);
  const auto result = replayed(trace_options(folder / "x.pcap", folder / "out"));
  CHECK(result.code == 0);
  CHECK_THAT(result.errors,
             Catch::Matchers::StartsWith("sweepd: ") && ContainsSubstring("cut off"));
  CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
  CHECK(result_in(folder / "out")["source"]["telegrams"] == 400);
}

TEST_CASE("a replay that is broken off leaves the result that was there, and what says whose it is",
          "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "x.pcap").add_stroke(ipoc, 0, 60);
  Capture(folder / "cut.pcap").add_stroke(ipoc, 0, 60);
  fs::resize_file(folder / "cut.pcap", fs::file_size(folder / "cut.pcap") - 7);
  CHECK(replayed(trace_options(folder / "x.pcap", folder / "out")).code == 0);
  const auto run = content(folder / "out/run.json");
  const auto result = content(folder / "out/result.json");
  auto options = trace_options(folder / "cut.pcap", folder / "out");
  options.force = true;
  class Refusing : public std::streambuf {
  } refusing;  // breaks it off where it tells of the cut
  std::ostringstream report;
  std::ostream errors(&refusing);
  errors.exceptions(std::ios::badbit);
  CHECK_THROWS_AS(replay(options, report, errors), std::ios::failure);
  CHECK(content(folder / "out/run.json") == run);
  CHECK(content(folder / "out/result.json") == result);
}

TEST_CASE("a capture that cannot be opened is said, and leaves no files", "[replay_command]") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(replayed(trace_options(folder / "missing.pcap", folder / "out")),
                  rsi::CaptureError);
  CHECK_THROWS_WITH(replayed(trace_options(folder / "missing.pcap", folder / "out")),
                    ContainsSubstring("missing.pcap: No such file"));
  CHECK_FALSE(fs::exists(folder / "out"));
}

TEST_CASE("an output folder that cannot be made is said with what to do", "[replay_command]") {
  const TemporaryFolder folder;
  Capture(folder / "x.pcap").add(telegram(4000, ""));
  CHECK_THROWS_WITH(
      replayed(trace_options(folder / "x.pcap", folder / "x.pcap/out")),
      ContainsSubstring((folder / "x.pcap/out").string()) && ContainsSubstring("--output"));
}

TEST_CASE("with several robots in the settings the port says whose capture it is",
          "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "x.pcap").add_stroke(ipoc, 0, 60);  // to port 49152
  auto wanted = trace_options(folder / "x.pcap", folder / "out");
  SECTION("one of them listens there") {
    wanted.config = folder.write("two.toml", robot_table("a", "1000") + robot_table("b", "49152"));
    CHECK(replayed(wanted).code == 0);
    CHECK(result_in(folder / "out")["robot"] == "b");
  }
  SECTION("none does: a configuration error, that --robot cures") {
    wanted.config = folder.write("two.toml", robot_table("a", "1000") + robot_table("b", "2000"));
    CHECK_THROWS_AS(replayed(wanted), sweepd::ConfigError);
    CHECK_THROWS_WITH(replayed(wanted),
                      ContainsSubstring("two.toml") && ContainsSubstring("--robot"));
    wanted.robot = kConfig / "robots/kr5_arc.toml";
    CHECK(replayed(wanted).code == 0);
    CHECK(result_in(folder / "out")["robot"] == "kr5-arc");
  }
}

TEST_CASE("without settings a description alone will do, or nothing", "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "x.pcap").add_stroke(ipoc, 0, 60);
  ReplayOptions wanted;
  wanted.traces = {folder / "x.pcap"};
  wanted.output = folder / "out";
  CHECK(replayed(wanted).code == 0);
  CHECK_FALSE(result_in(folder / "out").contains("specified"));
  wanted.robot = kConfig / "robots/kr5_arc.toml";
  CHECK(replayed(wanted).code == 0);
  CHECK(result_in(folder / "out").contains("specified"));
}

TEST_CASE("a plan tells the joints where telegrams carry no angles", "[replay_command]") {
  const TemporaryFolder folder;
  {
    Capture capture(folder / "x.pcap");
    std::uint64_t ipoc = 4000;
    for (const double angle : stroke_deg(0, 60)) {
      const auto all = joint_1_at(angle);
      capture.add(telegram(ipoc, all.substr(0, all.find("<AIPos"))));
      ipoc += 4;
    }
  }
  auto wanted = trace_options(folder / "x.pcap", folder / "out");
  wanted.plan = folder.write(
      "plan.toml",
      "home_deg = [0, -90, 90, 0, 90, 0]\npositioning_speed_deg_s = 60\n"
      "acceleration_deg_s2 = 200\ndwell_ms = 300\n[[sweep]]\njoint = 4\nstart_deg = 0\n"
      "end_deg = 60\nspeed_deg_s = 20\n");
  CHECK(replayed(wanted).code == 0);
  const auto result = result_in(folder / "out");
  CHECK(result["joints"][0]["sweeps"].empty());
  REQUIRE(result["joints"][3]["sweeps"].size() == 1);
  CHECK(result["joints"][3]["circle"]["radius_mm"].get<double>() == Approx(500).margin(1e-3));
}

TEST_CASE("a disk without room is an error of the replay", "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "x.pcap").add_stroke(ipoc, 0, 60);
  fs::create_directory(folder / "out");
  fs::create_symlink("/dev/full", folder / "out/samples.csv");
  const auto result = replayed(trace_options(folder / "x.pcap", folder / "out"));
  CHECK_THAT(result.errors,
             ContainsSubstring("sweepd: cannot write") && ContainsSubstring("samples.csv"));
  CHECK(result.code == 1);
  CHECK(result_in(folder / "out")["status"] == "partial");
}

TEST_CASE("names of files may hold any bytes", "[replay_command]") {
  const TemporaryFolder folder;
  std::uint64_t ipoc = 4000;
  Capture(folder / "x\xe4.pcap").add_stroke(ipoc, 0, 60);
  ReplayOptions wanted;
  wanted.traces = {folder / "x\xe4.pcap"};
  wanted.robot = folder / "r\xe4.toml";
  fs::copy_file(kConfig / "robots/kr5_arc.toml", *wanted.robot);
  wanted.output = folder / "out\xe4";
  CHECK(replayed(wanted).code == 0);
  CHECK(result_in(*wanted.output)["status"] == "partial");
  CHECK(Json::accept(content(*wanted.output / "run.json")));
}
