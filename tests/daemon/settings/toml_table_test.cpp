#include "daemon/settings/toml_table.hpp"

#include <filesystem>

#include "tests/catch.hpp"

using sweepd::ConfigError;
using sweepd::TomlTable;

namespace {

TomlTable toml(std::string_view text) {
  return TomlTable::parse(text, "some/file.toml");
}

/// The text of the ConfigError that `read` throws; "no error" if it does not.
template <typename Read>
std::string table_error(Read read) {
  try {
    (void)read();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

std::string unknown_key(std::string_view text, const std::vector<std::string_view>& known) {
  return table_error([&] {
    toml(text).allow_only(known);
    return 0;
  });
}

}  // namespace

TEST_CASE("values are read as they are written", "[toml_table]") {
  const auto t = toml(
      "word = \"KR 5\"\nyes = true\nwhole = 7\nbroken = -2.5e1\n"
      "numbers = [1, 2.5]\nwords = [\"a\", \"b\"]\n[sub]\nx = 1\n[[many]]\nx = 1\n[[many]]\nx = "
      "2\n");
  CHECK(t.text("word") == "KR 5");
  CHECK(t.flag("yes"));
  CHECK(t.whole_number("whole", 7, 7) == 7);
  CHECK(t.number("whole", 0, 10) == 7.0);
  CHECK(t.number("broken", -25, 0) == -25.0);
  CHECK(t.numbers("numbers", 1, 2.5) == std::vector<double>{1, 2.5});
  CHECK(t.texts("words") == std::vector<std::string>{"a", "b"});
  REQUIRE(t.table("sub"));
  CHECK(t.table("sub")->whole_number("x", 1, 1) == 1);
  CHECK_FALSE(t.table("absent"));
  REQUIRE(t.tables("many").size() == 2);
  CHECK(t.tables("many")[1].whole_number("x", 0, 9) == 2);
  CHECK(t.tables("many")[1].line() == 11);
  CHECK(t.has("whole"));
  CHECK_FALSE(t.has("hole"));
}

TEST_CASE("a table outlives the object that it was read from", "[toml_table]") {
  const auto inner = toml("[a.b]\nc = \"kept\"\n").table("a")->table("b");
  CHECK(inner->text("c") == "kept");
}

TEST_CASE("an unknown key is named with its place and the key that was probably meant",
          "[toml_table]") {
  const std::vector<std::string_view> known{"name", "listen", "silence_ms"};
  CHECK(unknown_key("name = 1\n  listn = 2\n", known) ==
        "some/file.toml:2:3: listn: unknown key: did you mean \"listen\"?");
  SECTION("two swapped letters count as one mistake") {
    CHECK_THAT(unknown_key("naem = 1", known), Catch::Matchers::EndsWith("did you mean \"name\"?"));
  }
  SECTION("a forgotten unit is a near miss") {
    CHECK_THAT(unknown_key("silence = 1", known),
               Catch::Matchers::EndsWith("did you mean \"silence_ms\"?"));
    CHECK_THAT(unknown_key("silence_s = 1", known),
               Catch::Matchers::EndsWith("did you mean \"silence_ms\"?"));
  }
  SECTION("where nothing is near, what is known is listed") {
    CHECK_THAT(
        unknown_key("colour = 1", known),
        Catch::Matchers::EndsWith("unknown key: this table may have name, listen, silence_ms"));
    CHECK_THAT(unknown_key(std::string(70'000, 'x') + " = 1", known),
               Catch::Matchers::ContainsSubstring("this table may have"));
  }
  SECTION("a table's key is checked where its header stands") {
    CHECK_THAT(unknown_key("name = 1\n[listening]\n", {"name"}),
               Catch::Matchers::StartsWith("some/file.toml:2:2: listening: unknown key"));
  }
  SECTION("of several each is reported, in the order of the file") {
    CHECK(unknown_key("nam = 1\nlisten = 2\nlistem = 3\n", known) ==
          "some/file.toml:1:1: nam: unknown key: did you mean \"name\"?\n"
          "some/file.toml:3:1: listem: unknown key: did you mean \"listen\"?");
  }
  SECTION("known keys pass") {
    CHECK(unknown_key("listen = 1", known) == "no error");
  }
}

TEST_CASE("a value of a wrong type is described beside what was expected, with its unit",
          "[toml_table]") {
  const auto t = toml(
      "silence_ms = \"abc\"\nspeed_deg_s = true\nname = 5\nrecord = 1.5\nhome_deg = [1, \"x\"]\n"
      "broken_ms = 1.5\ndate = 2020-01-01\nlist = [1]\nempty = \"\"\n");
  CHECK(table_error([&] { return t.whole_number("silence_ms", 0, 1); }) ==
        "some/file.toml:1:14: silence_ms: expected a whole number of milliseconds, found the "
        "string \"abc\": write it without quotes");
  CHECK_THAT(
      table_error([] { return toml("disk_bytes = \"5 GB\"").whole_number("disk_bytes", 0, 9); }),
      Catch::Matchers::EndsWith("write the number alone, without unit and quotes"));
  CHECK(table_error([&] { return t.number("speed_deg_s", 0, 1); }) ==
        "some/file.toml:2:15: speed_deg_s: expected a number of degrees per second, found true: "
        "correct it");
  CHECK(table_error([&] { return t.text("name"); }) ==
        "some/file.toml:3:8: name: expected a string, found the number 5: put it in quotes");
  CHECK_THAT(table_error([&] { return t.flag("record"); }),
             Catch::Matchers::ContainsSubstring("expected true or false, found the number 1.5"));
  CHECK_THAT(table_error([&] { return t.numbers("home_deg", 0, 1); }),
             Catch::Matchers::StartsWith(
                 "some/file.toml:5:16: home_deg: expected a number of degrees, found "
                 "the string \"x\""));
  CHECK_THAT(table_error([&] { return t.whole_number("broken_ms", 0, 9); }),
             Catch::Matchers::ContainsSubstring(
                 "expected a whole number of milliseconds, found the number 1.5: write it without "
                 "decimals"));
  CHECK_THAT(
      table_error([] { return toml("silence_ms = 2000.0").whole_number("silence_ms", 0, 9); }),
      Catch::Matchers::EndsWith("expected a whole number of milliseconds, found the number "
                                "2000.0: write 2000, without a decimal point"));
  CHECK_THAT(table_error([&] { return t.numbers("date", 0, 1); }),
             Catch::Matchers::ContainsSubstring("a date or a time"));
  CHECK_THAT(
      table_error([&] { return t.table("list"); }),
      Catch::Matchers::ContainsSubstring("expected a table [list], found an array of 1 value"));
  CHECK_THAT(table_error([&] { return t.texts("list"); }),
             Catch::Matchers::ContainsSubstring("found the number 1"));
  CHECK_THAT(table_error([&] { return t.text("empty"); }),
             Catch::Matchers::ContainsSubstring("found an empty one"));
}

TEST_CASE("a key that is too long is told by its beginning, also before the keys in its table",
          "[toml_table]") {
  const std::string key(100'000, 'k');
  const std::string shown = std::string(60, 'k') + "...";
  CHECK(table_error([&] { return toml("[" + key + "]\nx = 1").table(key)->text("x"); }) ==
        "some/file.toml:2:5: " + shown +
            ".x: expected a string, found the number 1: put it in "
            "quotes");
}

TEST_CASE("a number outside its range is told the range", "[toml_table]") {
  const auto t = toml("dwell_ms = 5\na_mm = -1e9\nnan = nan\nendless = inf\n");
  CHECK(table_error([&] { return t.whole_number("dwell_ms", 10, 600); }) ==
        "some/file.toml:1:12: dwell_ms: expected a whole number of milliseconds from 10 to 600, "
        "found the number 5: choose one in between");
  CHECK_THAT(table_error([&] { return t.number("a_mm", -0.5, 1e5); }),
             Catch::Matchers::ContainsSubstring(
                 "expected a number of millimetres from -0.5 to 1e+05, found the "
                 "number -1e+09"));
  CHECK_THAT(table_error([&] { return t.number("nan", 0, 1); }),
             Catch::Matchers::ContainsSubstring("found the number"));
  CHECK_THAT(table_error([&] { return t.number("endless", 0, 1); }),
             Catch::Matchers::ContainsSubstring("found the number inf"));
}

TEST_CASE("a mistake in TOML is one line, whatever the file holds", "[toml_table]") {
  for (const std::string text : {"name = 1\x01", "\x7f", "a = \"\x1f\""})
    CHECK(table_error([&] { return toml(text); }).find_first_of("\x01\x1f\x7f") ==
          std::string::npos);
  const auto t = toml("name = \"a\\nb\"\n");
  CHECK_THAT(table_error([&] { t.fail("name", "found " + t.text("name") + "\x1b\x7f"); }),
             Catch::Matchers::ContainsSubstring("name: found a?b??"));
}

TEST_CASE("a text that nests too deep for any stack is a mistake with its place",
          "[toml_table][issue11][point_4]") {
  const auto times = [](int count, const std::string& text) {
    std::string all;
    for (int k = 0; k < count; ++k) all += text;
    return all;
  };
  constexpr int kMany = 60'000;
  const auto key = times(kMany, "a.") + "a = 1";
  for (const std::string& text :
       {key, times(kMany, "a . ") + "a = 1", times(kMany, "'a'.") + "a = 1",
        "[" + times(kMany, "a.") + "a]", "[[" + times(kMany, "a.") + "a]]",
        "x = " + times(kMany, "["), "x = " + times(kMany, "{a = "),
        "x = " + times(kMany, "{a.b = "), "x = [\"\"\"a\"\"\"\"\", {" + key + "}]",
        "x = ['''a''''', {" + key + "}]", "x = [\"\", {" + key + "}]", "x = \"a\n" + key}) {
    INFO(text.substr(0, 40));
    CHECK_THAT(table_error([&] { return toml("first = 1\n" + text); }),
               Catch::Matchers::StartsWith("some/file.toml:2:") ||
                   Catch::Matchers::StartsWith("some/file.toml:3:"));
  }
  CHECK(table_error([&] { return toml("x = 1\n  [" + times(40, "a.") + "a]"); }) ==
        "some/file.toml:2:67: keys, tables or arrays are nested more than 32 deep: correct the "
        "file");

  // Dots that nest nothing.
  const auto sound = toml("# " + times(100, "a.") + "\nx = '" + times(100, "../") +
                          "'\ny = \"\\\"" + times(100, "..") + "\"\nz = [" + times(100, "1.5, ") +
                          "]\nw = \"\"\"\n" + times(100, "..\n") + "\"\"\"\n[a]\nb.c = 1\n");
  CHECK(sound.numbers("z", 0, 2).size() == 100);
  CHECK(sound.text("x").size() == 300);
  CHECK(sound.text("y").size() == 201);
}

TEST_CASE("a missing key is reported at the table that lacks it", "[toml_table]") {
  const auto t = toml("# nothing\n[[robot]]\nname = \"a\"\n").tables("robot")[0];
  CHECK(table_error([&] { return t.text("listen"); }) ==
        "some/file.toml:2:1: robot.listen: missing: expected a string: add it to this table");
}

TEST_CASE("an array of tables is not mistaken for a table", "[toml_table]") {
  CHECK_THAT(table_error([] { return toml("[robot]\nx = 1\n").tables("robot"); }),
             Catch::Matchers::ContainsSubstring("expected [[robot]], found a single table"));
  CHECK_THAT(table_error([] { return toml("robot = [1]\n").tables("robot"); }),
             Catch::Matchers::ContainsSubstring("expected a table [[robot]], found the number 1"));
  CHECK_THAT(table_error([] { return toml("robot = []\n").tables("robot"); }),
             Catch::Matchers::ContainsSubstring(
                 "at least one table [[robot]], found an array of 0 values"));
  CHECK_THAT(table_error([] { return toml("\n").tables("robot"); }),
             Catch::Matchers::EndsWith(
                 "missing: expected at least one table [[robot]]: add one for each robot"));
  CHECK_THAT(table_error([] { return toml("[robot]\nx = 1\n[robot]\n"); }),
             Catch::Matchers::EndsWith("write double brackets, [[...]], where there are several of "
                                       "them"));
  CHECK_THAT(
      table_error([] { return toml("[[robot]]\n").table("robot"); }),
      Catch::Matchers::ContainsSubstring("expected a table [robot], found an array of 1 value"));
}

TEST_CASE("a mistake of syntax has its place too", "[toml_table]") {
  CHECK_THAT(table_error([] { return toml("a = 1\nb = \n"); }),
             Catch::Matchers::StartsWith("some/file.toml:2:") &&
                 Catch::Matchers::ContainsSubstring("not valid TOML"));
  CHECK_THAT(table_error([] { return toml("a = 1\na = 2\n"); }),
             Catch::Matchers::StartsWith("some/file.toml:2:"));
  CHECK_THAT(table_error([] { return toml("a = \"\xff\"\n"); }),
             Catch::Matchers::StartsWith("some/file.toml:1:"));
}

TEST_CASE("text from a file cannot break a message apart", "[toml_table]") {
  const auto t = toml("a = \"line\\nbreak\\u001b[31m" + std::string(500, 'x') + "\"\n");
  const std::string error = table_error([&] { return t.number("a", 0, 1); });
  CHECK(error.find('\n') == std::string::npos);
  CHECK(error.find('\x1b') == std::string::npos);
  CHECK(error.size() < 200);
  CHECK_THAT(unknown_key("\"new\\nline\" = 1", {"a"}),
             Catch::Matchers::ContainsSubstring("new?line: unknown key"));
}

TEST_CASE("a file that cannot be read is named with the reason", "[toml_table]") {
  const auto folder = std::filesystem::temp_directory_path();
  CHECK_THAT(table_error([] { return TomlTable::load("/nowhere/sweepd.toml"); }),
             Catch::Matchers::StartsWith(
                 "/nowhere/sweepd.toml: cannot be read: No such file or directory"));
  CHECK_THAT(table_error([&] { return TomlTable::load(folder); }),
             Catch::Matchers::ContainsSubstring("cannot be read: Is a directory"));
  CHECK_THAT(table_error([] { return TomlTable::load("/dev/zero"); }),
             Catch::Matchers::ContainsSubstring("expected a TOML file of at most 1 MiB"));
}
