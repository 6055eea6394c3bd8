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
