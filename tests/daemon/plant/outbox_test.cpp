#include "daemon/plant/outbox.hpp"

#include <fstream>

#include <unistd.h>

#include "daemon/system/file_hash.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/small_disk.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace fs = std::filesystem;
using sweepd::Ledger;
using sweepd::Outbox;
using sweepd::test::content;
using sweepd::test::TemporaryFolder;
using PlantNames = std::vector<std::string>;

namespace {

const std::string kPlantResult = R"({"schema": "sweepd.result/1", "status": "complete"})";
const std::string kPlantEnded =
    R"({"command": "run", "started": "2026-01-01T00:00:00Z", "ended": "2026-01-01T00:09:00Z"})";

struct PlantFolder {
  TemporaryFolder folder;
  Ledger ledger{folder / "published"};
  Outbox outbox{folder / "robot", sweepd::Log("a")};

  void write(const std::string& session, const std::string& file, const std::string& text) const {
    fs::create_directories(folder / "robot" / session);
    std::ofstream(folder / "robot" / session / file, std::ios::binary) << text;
  }
  void finish(const std::string& session, const std::string& result = kPlantResult) const {
    write(session, "result.json", result);
    write(session, "run.json", kPlantEnded);
  }
  std::vector<std::string> sessions(std::size_t most = 9) {
    std::vector<std::string> names;
    for (const auto& result : outbox.take(most, ledger)) names.push_back(result.session);
    return names;
  }
};

}  // namespace

TEST_CASE("what the broker has acknowledged outlives the program", "[outbox]") {
  const TemporaryFolder folder;
  const auto file = folder / "published";
  {
    Ledger ledger(file);
    CHECK_FALSE(ledger.has("20260101T000000Z", "aa"));
    ledger.add("20260101T000000Z", "aa");
    ledger.add("20260101T000000Z", "aa");
    CHECK(ledger.has("20260101T000000Z", "aa"));
    CHECK_FALSE(ledger.has("20260101T000000Z", "bb"));
  }
  CHECK(content(file) == "20260101T000000Z aa\n");
  CHECK(Ledger(file).has("20260101T000000Z", "aa"));
}

TEST_CASE("the record tells whether a later session was published", "[outbox]") {
  const TemporaryFolder folder;
  Ledger ledger(folder / "published");
  CHECK_FALSE(ledger.has_later("20260101T000000Z"));
  ledger.add("20260101T000000Z-2", "aa");
  ledger.add("20260101T000000Z-10", "aa");
  CHECK(ledger.has_later("20260101T000000Z"));
  CHECK(ledger.has_later("20260101T000000Z-9"));
  CHECK_FALSE(ledger.has_later("20260101T000000Z-10"));
  CHECK_FALSE(ledger.has_later("20260102T000000Z"));
}

TEST_CASE("half a line of a crash is no line, and spoils none", "[outbox]") {
  const TemporaryFolder folder;
  const auto file = folder.write("published", "20260101T000000Z aa\n20260102T000000Z b");
  {
    Ledger ledger(file);
    CHECK(ledger.size() == 1);
    ledger.add("20260103T000000Z", "cc");
  }
  CHECK(content(file) == "20260101T000000Z aa\n20260103T000000Z cc\n");
}

TEST_CASE("a record that cannot be written is told with its place", "[outbox]") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(Ledger(folder / "none/published"),
                    Catch::Matchers::ContainsSubstring("none/published"));
  const auto file = folder / "published";
  Ledger ledger(file);
  ledger.add("20260101T000000Z", "aa");
  {
    const sweepd::test::SmallDisk disk(25);
    CHECK_THROWS_WITH(ledger.add("20260102T000000Z", "bb"),
                      Catch::Matchers::ContainsSubstring("free space"));
  }
  CHECK(ledger.has("20260102T000000Z", "bb"));
  ledger.add("20260103T000000Z", "cc");
  CHECK(content(file) == "20260101T000000Z aa\n20260103T000000Z cc\n");
}

TEST_CASE("finished results come once, oldest first, as they are on the disk", "[outbox]") {
  PlantFolder plant;
  plant.finish("20260102T000000Z");
  plant.finish("20260101T000000Z-2", kPlantResult + "\n");
  plant.finish("20260101T000000Z");
  plant.finish("other");
  const auto found = plant.outbox.take(2, plant.ledger);
  REQUIRE(found.size() == 2);
  CHECK(found[0].session == "20260101T000000Z");
  CHECK(found[1].session == "20260101T000000Z-2");
  CHECK(found[1].bytes == kPlantResult + "\n");
  CHECK(found[1].sha256 == sweepd::hash_of(found[1].folder / "result.json")->sha256);
  CHECK(found[0].ended == "2026-01-01T00:09:00Z");
  CHECK(plant.sessions() == PlantNames{"20260102T000000Z"});
  CHECK(plant.sessions().empty());
  SECTION("and again where one did not arrive") {
    plant.outbox.give_back("20260101T000000Z");
    CHECK(plant.sessions() == PlantNames{"20260101T000000Z"});
  }
  SECTION("or is another now") {
    plant.finish("20260102T000000Z", kPlantResult + "  ");
    CHECK(plant.sessions() == PlantNames{"20260102T000000Z"});
  }
  SECTION("but not what the broker has, after a restart") {
    for (const auto& result : found) plant.ledger.add(result.session, result.sha256);
    Outbox next(plant.folder / "robot", sweepd::Log("a"));
    const auto left = next.take(9, plant.ledger);
    REQUIRE(left.size() == 1);
    CHECK(left[0].session == "20260102T000000Z");
  }
}

TEST_CASE("what is not final, or only half there, is left alone", "[outbox]") {
  PlantFolder plant;
  plant.write("20260101T000000Z", "result.json", kPlantResult);  // half deleted
  plant.write("20260102T000000Z", "result.json", kPlantResult);  // interim
  plant.write("20260102T000000Z", "run.json", R"({"command": "run"})");
  plant.write("20260103T000000Z", "run.json", kPlantEnded);  // no usable sweep, or deleted
  plant.finish("20260104T000000Z", "{\"schema\":");
  plant.write("20260105T000000Z", "result.json", kPlantResult);  // being written
  plant.write("20260105T000000Z", "run.json", "{\"comm");
  plant.write("20260106T000000Z", "result.json", kPlantResult);
  plant.write("20260106T000000Z", "run.json", R"({"command": "watch"})");
  CHECK(plant.sessions().empty());
  CHECK(plant.outbox.unfinished().size() == 4);
  plant.write("20260102T000000Z", "run.json", kPlantEnded);
  CHECK(plant.sessions() == PlantNames{"20260102T000000Z"});
  CHECK(plant.outbox.before("20260104T000000Z").filename() == "20260102T000000Z");
  CHECK(plant.outbox.before("20260102T000000Z").empty());
}

TEST_CASE("what may not be read is not published, until it may be", "[outbox]") {
  PlantFolder plant;
  plant.finish("20260101T000000Z");
  plant.finish("20260102T000000Z");
  plant.finish("20260103T000000Z");
  const fs::path robot = plant.folder / "robot";
  const auto open_to = [&](fs::perms permissions) {
    fs::permissions(robot / "20260101T000000Z", permissions);
    fs::permissions(robot / "20260102T000000Z" / "result.json", permissions);
    fs::permissions(robot / "20260103T000000Z" / "run.json", permissions);
  };
  open_to(fs::perms::none);
  fs::permissions(plant.folder.path(), fs::perms::all);
  constexpr ::uid_t kNobody = 65534;  // root may read everything
  const bool is_root = ::geteuid() == 0;
  if (is_root) REQUIRE(::seteuid(kNobody) == 0);
  const auto found = plant.sessions();
  const auto complaints = plant.outbox.complaints();
  if (is_root) REQUIRE(::seteuid(0) == 0);
  CHECK(found.empty());
  CHECK(complaints == 3);
  open_to(fs::perms::all);
  CHECK(plant.sessions().size() == 3);
}
