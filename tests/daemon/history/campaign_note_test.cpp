#include "daemon/history/campaign_note.hpp"

#include <chrono>

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace std::chrono_literals;
using sweepd::append_note;
using sweepd::kNotesFile;
using sweepd::parse_notes;
using sweepd::test::content;
using sweepd::test::TemporaryFolder;

TEST_CASE("notes are read as they were written", "[campaign_note]") {
  const TemporaryFolder folder;
  append_note(folder.path(), {1'700'000'000s, "collision, A4: \"hard\"\n\xff", {}, false});
  append_note(folder.path(), {1'600'000'000s, "", std::string("new"), true});
  append_note(folder.path(), {1'600'000'000s, "", std::string(), false});
  const auto found = parse_notes(content(folder / kNotesFile));
  REQUIRE(found.notes.size() == 3);
  CHECK(found.broken_lines.empty());
  CHECK(found.notes[0].time == 1'700'000'000s);
  CHECK(found.notes[0].text == "collision, A4: \"hard\"\n\xef\xbf\xbd");
  CHECK_FALSE(found.notes[0].same_state);
  CHECK(found.notes[1].same_state == std::optional(std::string("new")));
  CHECK(found.notes[1].measured);
  CHECK(found.notes[2].same_state == std::optional(std::string()));
}

TEST_CASE("lines that are no notes are passed over and named", "[campaign_note]") {
  const auto found = parse_notes(
      "{\"time\":\"2026-01-01\",\"text\":\"a\"}\n\nnonsense\n{\"text\":\"no time\"}\n[1]\n"
      "{\"time\":\"2026-01-02T10:00:00.000Z\",\"text\":7}");
  CHECK(found.notes.size() == 2);
  CHECK(found.notes[1].text.empty());
  CHECK(found.broken_lines == std::vector<std::size_t>{3, 4, 5});
}

TEST_CASE("a note after a line that was cut stands in a line of its own", "[campaign_note]") {
  const TemporaryFolder folder;
  (void)folder.write(kNotesFile, "{\"time\":\"2026-");
  append_note(folder.path(), {0s, "whole", {}, false});
  const auto found = parse_notes(content(folder / kNotesFile));
  REQUIRE(found.notes.size() == 1);
  CHECK(found.notes[0].text == "whole");
  CHECK(found.broken_lines == std::vector<std::size_t>{1});
}

TEST_CASE("a folder that cannot be written is named", "[campaign_note]") {
  CHECK_THROWS_WITH(append_note("/nowhere", {}),
                    Catch::Matchers::ContainsSubstring("cannot write /nowhere/notes.jsonl"));
}
