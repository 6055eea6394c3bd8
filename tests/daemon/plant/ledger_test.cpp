#include "daemon/plant/ledger.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/small_disk.hpp"
#include "tests/daemon/temporary_folder.hpp"

using sweepd::Ledger;
using sweepd::test::content;
using sweepd::test::TemporaryFolder;

TEST_CASE("what the broker has acknowledged outlives the program", "[ledger]") {
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

TEST_CASE("half a line of a crash is no line, and spoils none", "[ledger]") {
  const TemporaryFolder folder;
  const auto file = folder.write("published", "20260101T000000Z aa\n20260102T000000Z b");
  {
    Ledger ledger(file);
    CHECK(ledger.size() == 1);
    ledger.add("20260103T000000Z", "cc");
  }
  CHECK(content(file) == "20260101T000000Z aa\n20260103T000000Z cc\n");
}

TEST_CASE("a record that cannot be written is told with its place", "[ledger]") {
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
