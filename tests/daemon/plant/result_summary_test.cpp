#include "daemon/plant/result_summary.hpp"

#include <nlohmann/json.hpp>

#include "tests/catch.hpp"

TEST_CASE("a summary says of which robot, what, and of which bytes", "[result_summary]") {
  const sweepd::FinishedResult result{
      "20260101T000000Z",
      "/out/a/20260101T000000Z",
      R"({"schema": "sweepd.result/1", "status": "doubtful", "describes": "arm",
          "joints": [{}, {}], "doubts": [{}], "warnings": []})",
      "aa",
      "2026-01-01T00:00:00Z",
      ""};
  const auto json = nlohmann::json::parse(sweepd::result_summary({"n", "h", "a"}, result));
  CHECK(json == nlohmann::json::parse(
                    R"({"schema": "sweepd.summary/1", "site": "n", "cell": "h", "robot": "a",
                        "session": "20260101T000000Z", "started": "2026-01-01T00:00:00Z",
                        "status": "doubtful", "describes": "arm", "joints": 2, "doubts": 1,
                        "warnings": 0, "bytes": 133, "sha256": "aa"})"));
}

TEST_CASE("what cannot be compared says why", "[result_summary]") {
  const auto change = sweepd::change_since("/missing", {"s", "/f", "{}", "", "", ""});
  CHECK_FALSE(change.json);
  CHECK_THAT(change.why_not, Catch::Matchers::ContainsSubstring("/missing: cannot be read"));
}
