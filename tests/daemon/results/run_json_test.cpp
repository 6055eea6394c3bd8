#include "daemon/results/run_json.hpp"

#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/daemon/small_disk.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Json = nlohmann::json;
using namespace sweepd;
using namespace sweepd::test;

namespace {

/// Of a session that has begun.
std::string begun_session() {
  RunFacts facts;
  facts.robot = R"("recording_paused": false)";
  facts.inputs = {{"robot.toml", 3, "before"}};
  facts.watched_on = "eth0";
  return run_json(facts);
}

}  // namespace

TEST_CASE("a full disk takes the mark that a recording paused", "[run_json]") {
  const TemporaryFolder folder;
  const auto run = begun_session();
  static_cast<void>(folder.write("run.json", run));
  CHECK_FALSE(recording_paused(folder.path()));
  {
    const SmallDisk full(run.size());  // it cannot grow
    mark_recording_paused(folder.path());
  }
  CHECK(recording_paused(folder.path()));
  auto expected = Json::parse(run);
  expected["recording_paused"] = true;
  CHECK(Json::parse(content(folder / "run.json")) == expected);

  static_cast<void>(folder.write("run.json", "{"));
  mark_recording_paused(folder.path());
  CHECK(content(folder / "run.json") == "{");
  CHECK_FALSE(recording_paused(folder.path()));
}

TEST_CASE("of a session that was cut run.json tells what its result was made of, and no old counts",
          "[run_json]") {
  const TemporaryFolder folder;
  static_cast<void>(folder.write("run.json", begun_session()));
  const CutSession cut{"20250101T000000Z", {{{"robot.toml", 4, "now"}}}, {"a packet is cut"}};
  const auto run = Json::parse(run_json_of_cut_session(folder.path(), cut));
  CHECK(run["inputs"][0]["sha256"] == "before");
  CHECK(run["recovered"]["inputs"][0]["sha256"] == "now");
  CHECK(run["recovered"]["sweepd"] == SWEEPD_VERSION);
  CHECK(run["from_recording"] == true);
  CHECK(run["ended"] == "20250101T000000Z");
  CHECK(run["damage"] == Json{"a packet is cut"});
  CHECK(run["watched"] == Json{{"interface", "eth0"}});
  CHECK_FALSE(run.contains("since_start_of_sweepd"));
  CHECK_FALSE(run.contains("recording_paused"));

  mark_recording_paused(folder.path());
  const auto stays = Json::parse(run_json_of_cut_session(folder.path(), {"now", {}, {}}));
  CHECK(stays["recording_paused"] == true);
  CHECK_FALSE(stays.contains("recovered"));
  CHECK_FALSE(stays.contains("from_recording"));
  CHECK_FALSE(stays.contains("damage"));
}

TEST_CASE("a session tells that somebody deleted what was recorded before", "[run_json]") {
  const TemporaryFolder folder;
  mark_recording_deleted(folder.path());  // there is nothing to mark
  CHECK_FALSE(recording_deleted(folder.path()));
  static_cast<void>(folder.write("run.json", begun_session()));
  CHECK_FALSE(recording_deleted(folder.path()));
  mark_recording_deleted(folder.path());
  CHECK(recording_deleted(folder.path()));
  CHECK_FALSE(recording_paused(folder.path()));
  CHECK(Json::parse(run_json_of_cut_session(folder.path(), {}))["recording_deleted"] == true);
}
