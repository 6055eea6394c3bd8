#include "daemon/commands/outputs.hpp"

#include <csignal>
#include <sstream>

#include <sys/wait.h>
#include <unistd.h>

#include "daemon/commands/export_command.hpp"
#include "daemon/commands/identify_command.hpp"
#include "daemon/commands/inspect_command.hpp"
#include "daemon/commands/plan_command.hpp"
#include "daemon/commands/replay_command.hpp"
#include "daemon/commands/simulate_command.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

namespace {

/// A folder with a capture, and what commands say of writing there.
struct OutputsBench {
  TemporaryFolder folder;
  fs::path trace = folder / "t.pcap";
  std::string bytes;
  std::ostringstream ignored;

  OutputsBench() {
    std::uint64_t ipoc = 4000;
    Capture(trace).add_stroke(ipoc, 0, 60);
    bytes = content(trace);
  }
  int exported(const fs::path& csv, bool force = false) {
    return export_csv({{trace}, csv, {}, force}, ignored, ignored);
  }
  int inspected(const fs::path& json, bool force = false) {
    return inspect({.traces = {trace}, .json = json, .quiet = true, .force = force}, ignored,
                   ignored);
  }
  int replayed(const fs::path& output, bool force = false) {
    ReplayOptions options;
    options.traces = {trace};
    options.output = output;
    options.quiet = true;
    options.force = force;
    return replay(options, ignored, ignored);
  }
  int identified(const fs::path& points, const fs::path& output, bool force = false) {
    IdentifyOptions options;
    options.points = {points};
    options.output = output;
    options.quiet = true;
    options.force = force;
    return identify_points(options, ignored);
  }
  int simulated(const fs::path& capture, bool force = false) {
    SimulateOptions options;
    options.robot = kConfig / "robots/kr5_arc.toml";
    options.plan = kConfig / "plans/kr5_arc_30deg.toml";
    options.write = capture;
    options.cycle_ms = 100;
    options.quiet = true;
    options.force = force;
    return simulate(options, ignored, ignored);
  }
};

}  // namespace

TEST_CASE("no command overwrites what it reads, by whatever name, even if it is forced",
          "[outputs][issue11][point_11]") {
  OutputsBench bench;
  fs::create_symlink(bench.trace, bench.folder / "symbolic");
  fs::create_hard_link(bench.trace, bench.folder / "hard");
  for (const bool force : {false, true})
    for (const char* name : {"t.pcap", "symbolic", "hard", "./t.pcap"}) {
      CAPTURE(force, name);
      CHECK_THROWS_WITH(bench.exported(bench.folder / name, force),
                        ContainsSubstring("this command reads it"));
      CHECK_THROWS_WITH(bench.inspected(bench.folder / name, force),
                        ContainsSubstring("this command reads it"));
    }
  CHECK((content(bench.trace) == bench.bytes));
  CHECK(bench.replayed(bench.folder / "out") == 0);
  const auto points = bench.folder / "out/sweeps.csv";
  const auto before = content(points);
  CHECK_THROWS_WITH(bench.identified(points, bench.folder / "out", true),
                    ContainsSubstring("sweeps.csv is not overwritten: this command reads it"));
  CHECK((content(points) == before));
}

TEST_CASE("what is there and not of sweepd is overwritten only by force",
          "[outputs][issue11][point_11]") {
  OutputsBench bench;
  const auto other = bench.folder.write("other", "precious\n");
  CHECK_THROWS_WITH(bench.exported(other), ContainsSubstring("--force"));
  CHECK_THROWS_WITH(bench.inspected(other), ContainsSubstring("--force"));
  CHECK_THROWS_WITH(bench.simulated(other), ContainsSubstring("--force"));
  const auto recorded = bench.folder / "recorded.pcap";
  rsi::CaptureWriter(recorded).write(from_controller("x", std::chrono::seconds(1'735'689'601)));
  const auto bytes = content(recorded);
  CHECK_THROWS_WITH(bench.simulated(recorded), ContainsSubstring("--force"));
  CHECK(content(other) == "precious\n");
  CHECK(content(recorded) == bytes);

  fs::create_directory(bench.folder / "own");
  const auto points = bench.folder.write("own/samples.csv", "my points\n");
  CHECK_THROWS_WITH(bench.replayed(bench.folder / "own"),
                    ContainsSubstring("samples.csv is not overwritten"));
  CHECK(content(points) == "my points\n");
  CHECK_FALSE(fs::exists(bench.folder / "own/run.json"));
  fs::create_directory(bench.folder / "session");
  static_cast<void>(
      bench.folder.write("session/run.json", R"({"schema": "sweepd.run/1", "command": "run"})"));
  CHECK_THROWS_WITH(bench.replayed(bench.folder / "session"),
                    ContainsSubstring("it belongs to a recording"));
  static_cast<void>(bench.folder.write("session/samples.csv", "t_s,ipoc,x_mm\n"));
  CHECK_THROWS_WITH(bench.exported(bench.folder / "session/samples.csv"),
                    ContainsSubstring("it belongs to a recording"));

  CHECK(bench.exported(other, true) == 0);
  CHECK_THAT(content(other), Catch::Matchers::StartsWith("t_s,ipoc,RIst.X"));
  CHECK(bench.replayed(bench.folder / "own", true) == 0);
  CHECK(content(points) != "my points\n");
}

TEST_CASE("what sweepd wrote may be written again, and links and devices are what they were",
          "[outputs][issue11][point_11]") {
  OutputsBench bench;
  const auto to = [&](const char* name) { return bench.folder / name; };
  fs::create_symlink(to("t.csv"), to("link"));
  static_cast<void>(bench.folder.write("empty", ""));
  for (int again = 0; again < 2; ++again) {
    CAPTURE(again);
    CHECK(bench.exported(to("t.csv")) == 0);
    CHECK(bench.exported(to("link")) == 0);
    CHECK(bench.exported(to("empty")) == 0);
    CHECK(bench.exported("/dev/null") == 0);
    CHECK(bench.inspected(to("t.json")) <= 1);
    CHECK(bench.inspected("/dev/null") <= 1);
    CHECK(bench.simulated(to("s.pcap")) == 0);
    CHECK(bench.replayed(to("out")) == 0);
  }
  CHECK(fs::is_symlink(to("link")));
  CHECK(fs::is_character_file("/dev/null"));
  CHECK(bench.identified(to("out") / "samples.csv", to("points")) == 0);
  CHECK(bench.identified(to("out") / "samples.csv", to("points")) == 0);
  for (const auto& entry : fs::recursive_directory_iterator(bench.folder.path()))
    CHECK_FALSE(entry.path().filename().string().ends_with('~'));
}

TEST_CASE("programs and plans that were edited stay", "[outputs][issue11][point_11]") {
  const TemporaryFolder folder;
  const Outputs outputs({}, false);
  const auto program = folder / "sweeps.src";
  outputs.check_same(program, "DEF sweeps()\n");
  write_output(program, "DEF sweeps()\n");
  outputs.check_same(program, "DEF sweeps()\n");
  CHECK_THROWS_WITH(outputs.check_same(program, "DEF"), ContainsSubstring("holds something else"));
  static_cast<void>(folder.write("sweeps.src", "DEF sweeps()\n; taught by hand\n"));
  CHECK_THROWS_WITH(outputs.check_same(program, "DEF sweeps()\n"), ContainsSubstring("--force"));
  Outputs({}, true).check_same(program, "DEF sweeps()\n");
}

TEST_CASE("a file that was not finished leaves the one before it", "[outputs][issue11][point_11]") {
  const TemporaryFolder folder;
  const auto file = folder.write("x", "before");
  {
    const OutputFile output(file);
    static_cast<void>(folder.write(output.beside().filename().string(), "half"));
  }
  CHECK(content(file) == "before");
  CHECK_THROWS_WITH(OutputFile(file / "y"),
                    ContainsSubstring("cannot write " + file.string() + "/y "));
  CHECK_THROWS_WITH(OutputFile(folder / "none/y"), ContainsSubstring("make that folder first"));
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("a signal in the middle of a file leaves the one before it, and nothing beside it",
          "[outputs]") {
  const TemporaryFolder folder;
  const auto file = folder.write("x", "before");
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGINT, SIG_DFL);
    delete_unfinished_on_signals();
    const OutputFile output(file);
    raise(SIGINT);
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(content(file) == "before");
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("what was watched is a recording, whose files no command overwrites", "[outputs]") {
  const std::string command = GENERATE("run", "watch");
  const TemporaryFolder folder;
  static_cast<void>(
      folder.write("run.json", R"({"schema": "sweepd.run/1", "command": ")" + command + R"("})"));
  static_cast<void>(folder.write("samples.csv", "recorded"));
  CHECK_THROWS_WITH(Outputs({}, false).check_results(folder.path(), {"samples.csv"}),
                    ContainsSubstring("it belongs to a recording"));
}
