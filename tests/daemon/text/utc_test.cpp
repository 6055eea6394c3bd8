#include "daemon/text/utc.hpp"

#include "tests/catch.hpp"

using namespace std::chrono_literals;

TEST_CASE("times are written in UTC with milliseconds, rounded down", "[utc]") {
  CHECK(sweepd::utc_text(0ns) == "1970-01-01T00:00:00.000Z");
  CHECK(sweepd::utc_text(1'735'689'600s + 4'999'999ns) == "2025-01-01T00:00:00.004Z");
  CHECK(sweepd::utc_text(951'827'696s) == "2000-02-29T12:34:56.000Z");
  CHECK(sweepd::utc_text(-1ns) == "1969-12-31T23:59:59.999Z");
}

TEST_CASE("a time names a folder in the basic form, in whole seconds", "[utc]") {
  CHECK(sweepd::utc_name(std::chrono::nanoseconds(0)) == "19700101T000000Z");
  CHECK(sweepd::utc_name(std::chrono::milliseconds(1'735'689'600'999)) == "20250101T000000Z");
}

TEST_CASE("dates are read in both forms, and nothing else is", "[utc]") {
  using sweepd::parse_utc;
  CHECK(parse_utc("1970-01-02") == 24h);
  CHECK(parse_utc("19700102T010203Z") == 25h + 2min + 3s);
  CHECK(parse_utc("1970-01-01 01:02") == 1h + 2min);
  CHECK(parse_utc("1970-01-01T01:02:03.25Z") == 1h + 2min + 3s + 250ms);
  CHECK(parse_utc("1970-01-01T01:02Z") == 1h + 2min);
  CHECK(parse_utc("2000-02-29T12:34:56.000Z") == 951'827'696s);
  for (const char* wrong :
       {"", "1970", "1970-01", "1970-13-01", "2023-02-29", "1970-01-01T", "1970-01-01T1",
        "1970-01-01T24:00", "1970-01-01T10:60", "1970-01-01T10:00:60", "1970-01-01X",
        "1970-01-01T10:00Zx", "-970-01-01", "1970-01-01T10:00:00.x", "2426-11-23", "0001-01-01"})
    CHECK_FALSE(parse_utc(wrong));
}
