#include "daemon/service/identifier.hpp"

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "tests/catch.hpp"
#include "tests/daemon/said_lines.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/eventually.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

struct IdentifierBench {
  TemporaryFolder folder;
  std::shared_ptr<RobotStatus> status = std::make_shared<RobotStatus>();
  Identifier identifier{status};

  IdentifierBench() { spdlog::set_level(spdlog::level::off); }
  /// The end of a session without sweeps.
  SessionEnd end(const std::string& name, std::shared_ptr<const Recording> recording) const {
    SessionEnd end{folder.path(), name, std::move(recording), {}, {},
                   LinkFiles(),   {},   Log("robot")};
    end.snapshot.robot = "robot";
    end.snapshot.source_kind = "trace";
    end.snapshot.campaign.joints = 6;
    end.run = [](const fs::path&) { return std::string(R"({"command": "run", "ended": "now"})"); };
    return end;
  }
};

}  // namespace

TEST_CASE("a result that the disk refuses is pending, and tried again until it is written",
          "[identifier][issue11][point_10]") {
  IdentifierBench bench;
  const auto session = bench.folder / "20250101T000000Z";
  fs::create_directories(session / "result.json.tmp");  // in the way of the file
  const auto recording = std::make_shared<Recording>();
  recording->made(session);
  recording->finish();
  bench.identifier.last(bench.end("20250101T000000Z", recording));
  REQUIRE(bench.identifier.drain(std::chrono::steady_clock::now() + 20s));
  CHECK(bench.identifier.results().pending == 1);
  CHECK_FALSE(fs::exists(session / "run.json"));  // not everything is final
  CHECK(bench.identifier.results().refused == 1);
  // Not before its time.
  bench.identifier.try_again(std::chrono::steady_clock::time_point());
  CHECK(bench.identifier.results().pending == 1);

  fs::remove(session / "result.json.tmp");
  bench.identifier.try_again(std::chrono::steady_clock::time_point::max());
  REQUIRE(eventually([&] { return bench.identifier.results().pending == 0; }));
  CHECK(fs::exists(session / "result.json"));
  CHECK(fs::exists(session / "run.json"));
  CHECK(bench.identifier.results().refused == 0);
  CHECK(bench.identifier.results().given_up == 0);
}

TEST_CASE("what is not in the recording of a session is said once at its end", "[identifier]") {
  const SaidLines said;
  IdentifierBench bench;
  spdlog::set_level(spdlog::level::info);
  const auto recording = std::make_shared<Recording>();
  recording->paused();
  recording->lost(Missing::disk, {12, 6});
  recording->finish();
  bench.identifier.last(bench.end("20250101T000000Z", recording));
  REQUIRE(bench.identifier.drain(std::chrono::steady_clock::now() + 20s));
  spdlog::set_level(spdlog::level::off);
  CHECK_THAT(said.text(), ContainsSubstring("robot: the recording of this session paused 1 time, "
                                            "and lacks 12 datagrams and 6 samples as the disk"));
}

TEST_CASE("a folder that is deleted while its result is pending is made anew, with all files",
          "[identifier][issue11][point_10][point_12]") {
  IdentifierBench bench;
  const auto session = bench.folder / "20250101T000000Z";
  fs::create_directories(session / "run.json.tmp");  // in the way of the last file
  const auto recording = std::make_shared<Recording>();
  recording->made(session);
  recording->finish();
  bench.identifier.last(bench.end("20250101T000000Z", recording));
  REQUIRE(bench.identifier.drain(std::chrono::steady_clock::now() + 20s));
  CHECK(fs::exists(session / "result.json"));
  fs::remove_all(session);
  bench.identifier.try_again(std::chrono::steady_clock::time_point::max());
  REQUIRE(eventually([&] { return bench.identifier.results().pending == 0; }));
  CHECK(fs::exists(session / "result.json"));
  CHECK(fs::exists(session / "run.json"));
}

TEST_CASE("a session for which the disk had no folder gets one with its result",
          "[identifier][issue11][point_10]") {
  IdentifierBench bench;
  const auto recording = std::make_shared<Recording>();
  recording->finish();
  bench.identifier.last(bench.end("20250101T000000Z", recording));
  REQUIRE(eventually([&] { return bench.identifier.results().pending == 0; }));
  CHECK(fs::exists(bench.folder / "20250101T000000Z/result.json"));
}

TEST_CASE("a session that has no folder is tried in the one that was given since", "[identifier]") {
  IdentifierBench bench;
  const auto recording = std::make_shared<Recording>();
  recording->finish();
  auto end = bench.end("20250101T000000Z", recording);
  end.robot_folder = bench.folder.write("file", "") / "robot";
  bench.identifier.last(std::move(end));
  REQUIRE(bench.identifier.drain(std::chrono::steady_clock::now() + 20s));
  CHECK(bench.identifier.results().pending == 1);

  bench.identifier.write_to(bench.folder / "corrected");
  bench.identifier.try_again(std::chrono::steady_clock::time_point::max());
  REQUIRE(eventually([&] { return bench.identifier.results().pending == 0; }));
  CHECK(fs::exists(bench.folder / "corrected/20250101T000000Z/result.json"));
}

TEST_CASE("of sessions that wait for a disk that hangs the oldest are given up",
          "[identifier][issue11][point_12]") {
  constexpr std::size_t kSessions = Identifier::kMostWaiting + 10;
  IdentifierBench bench;
  std::vector<std::shared_ptr<Recording>> recordings;
  for (std::size_t k = 0; k < kSessions; ++k) {
    recordings.push_back(std::make_shared<Recording>());
    bench.identifier.last(
        bench.end("20250101T0000" + std::to_string(10 + k % 50) + "Z-" + std::to_string(k + 2),
                  recordings.back()));
  }
  const auto waiting = bench.identifier.results();
  CHECK(waiting.pending <= Identifier::kMostWaiting + 1);  // one is under way
  CHECK(waiting.pending + waiting.given_up == kSessions);
  CHECK(waiting.refused == 0);  // nothing has been written yet
  for (const auto& recording : recordings) recording->finish();
  REQUIRE(eventually([&] { return bench.identifier.results().pending == 0; }));
  const auto written = static_cast<std::size_t>(
      std::distance(fs::directory_iterator(bench.folder.path()), fs::directory_iterator()));
  CHECK(written == waiting.pending);
  CHECK(eventually([&] { return recordings.back().use_count() == 1; }));
}

TEST_CASE("a session without a usable sweep leaves one small folder",
          "[identifier][issue11][point_12]") {
  IdentifierBench bench;
  const auto session = bench.folder / "20250101T000000Z";
  fs::create_directory(session);
  const auto recording = std::make_shared<Recording>();
  recording->made(session);
  recording->finish();
  auto end = bench.end("20250101T000000Z", recording);
  bench.identifier.last(std::move(end));
  REQUIRE(eventually([&] { return bench.identifier.results().pending == 0; }));
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(session))
    names.insert(entry.path().filename().string());
  CHECK(names == std::set<std::string>{"result.json", "run.json"});
}
