#include "daemon/history/time_axis.hpp"

#include "daemon/history/history.hpp"
#include "daemon/text/utc.hpp"
#include "tests/catch.hpp"

using sweepd::date_ticks;
using sweepd::Range;

namespace {

std::string names(const char* from, const char* to, std::size_t about) {
  std::string text;
  for (const auto& [at, name] : date_ticks(
           Range{sweepd::years(*sweepd::parse_utc(from)), sweepd::years(*sweepd::parse_utc(to))},
           about))
    text += name + ' ';
  return text;
}

}  // namespace

TEST_CASE("dates below a plot are round", "[time_axis]") {
  CHECK(names("2013-01-15", "2026-04-16", 5) == "2015 2020 2025 ");
  CHECK(names("2013-01-15", "2026-04-16", 8) == "2014 2016 2018 2020 2022 2024 2026 ");
  CHECK(names("2024-02-15", "2025-04-16", 5) == "2024-04 2024-07 2024-10 2025-01 2025-04 ");
  CHECK(names("2024-02-20", "2024-03-12", 5) == "02-20 02-25 03-01 03-06 03-11 ");
  CHECK(names("2024-02-20", "2024-02-20", 5) == "02-20 ");
  CHECK(names("2024-02-20T09:10", "2024-02-20T11:20", 5) == "09:30 10:00 10:30 11:00 ");
  CHECK(names("2024-02-20T22:00", "2024-02-21T14:00", 5) == "02-21 06:00 12:00 ");
  CHECK(names("2024-02-20T09:10", "2024-02-20T09:14", 5) == "09:10 09:11 09:12 09:13 09:14 ");
}
