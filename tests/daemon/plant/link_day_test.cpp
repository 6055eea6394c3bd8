#include "daemon/plant/link_day.hpp"

#include "tests/catch.hpp"

using sweepd::counted_since;
using sweepd::link_told;
using sweepd::ToldLink;

namespace {

ToldLink told_counters(const std::string& started, std::int64_t received, std::int64_t lost) {
  return {"2026-01-03", "2026-01-03", {started, {received, lost}}};
}

}  // namespace

TEST_CASE("a state tells its day, its counts and the worst latency", "[link_day]") {
  const auto told = link_told(nlohmann::ordered_json::parse(
      R"({"at": "2026-11-23T11:00:00Z", "started": "2026-11-01T00:00:00Z", "robots": [
        {"telegrams": {"received": 9, "lost": 2}, "replies": {"late": 3, "superseded": 1},
         "stream": {"since": "2026-11-22T09:00:00Z", "reply_latency": {"max_us": 250.5}}}]})"));
  REQUIRE(told);
  CHECK(told->day == "2026-11-23");
  CHECK(told->counters.started == "2026-11-01T00:00:00Z");
  CHECK(told->counters.counts == std::array<std::int64_t, 8>{9, 2, 0, 0, 0, 3, 0, 1});
  CHECK(told->max_latency_us == 250.5);
  CHECK(told->stream_since == "2026-11-22");
}

TEST_CASE("without a stream, or without a reply in it, there is no latency", "[link_day]") {
  for (const char* const stream :
       {"null", R"({"since": "2026-11-23T09:00:00Z"})",
        R"({"since": "2026-11-23T09:00:00Z", "reply_latency": {"max_us": 0}})"}) {
    INFO(stream);
    const auto told = link_told(nlohmann::ordered_json::parse(
        R"({"at": "2026-11-23T11:00:00Z", "started": "x", "robots": [{"stream": )" +
        std::string(stream) + "}]}"));
    REQUIRE(told);
    CHECK_FALSE(told->max_latency_us);
  }
}

TEST_CASE("a state without day, start or robot tells nothing", "[link_day]") {
  for (const char* const text :
       {"null", "{}", R"({"at": "2026-11-23T", "started": "x", "robots": []})",
        R"({"at": "yesterday", "started": "x", "robots": [{}]})",
        R"({"at": "2026-11-23T", "robots": [{}]})"}) {
    INFO(text);
    CHECK_FALSE(link_told(nlohmann::ordered_json::parse(text)));
  }
}

TEST_CASE("what was counted is counted once", "[link_day]") {
  const auto first = told_counters("2026-01-01", 100, 5).counters;
  SECTION("the first state counts whole") {
    CHECK(counted_since({}, told_counters("2026-01-01", 100, 5))->counts[0] == 100);
  }
  SECTION("then the difference") {
    const auto counted = counted_since(first, told_counters("2026-01-01", 150, 6));
    REQUIRE(counted);
    CHECK(counted->counts[0] == 50);
    CHECK(counted->counts[1] == 1);
  }
  SECTION("a state that comes twice, or late, counts nothing") {
    CHECK_FALSE(counted_since(first, told_counters("2026-01-01", 100, 5)));
    CHECK_FALSE(counted_since(first, told_counters("2026-01-01", 90, 5)));
    CHECK_FALSE(counted_since(first, told_counters("2025-12-31", 900, 5)));
  }
  SECTION("a sweepd that was started again counts from zero") {
    CHECK(counted_since(first, told_counters("2026-01-02", 30, 0))->counts[0] == 30);
  }
  SECTION("a clock that was years ahead does not end the counting") {
    const auto ahead = told_counters("2036-01-01", 100, 5).counters;
    CHECK(counted_since(ahead, told_counters("2026-01-02", 30, 0))->counts[0] == 30);
  }
}
