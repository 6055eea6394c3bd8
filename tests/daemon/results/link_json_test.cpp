#include <random>

#include <nlohmann/json.hpp>

#include "daemon/results/link_files.hpp"
#include "rsi/link/link.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/link_stream.hpp"

using namespace rsi::test;
using Json = nlohmann::json;
using namespace std::chrono_literals;
using sweepd::link_bins;

namespace {

Json json_of(const rsi::Link& monitor) {
  return Json::parse(sweepd::link_json({kController.address, kServer}, monitor.report()));
}

}  // namespace

TEST_CASE("the JSON of a link holds every figure with its unit", "[link_json]") {
  rsi::Link monitor;
  LinkStream stream(monitor);
  stream.cycles(0, 500, 50us);
  stream.telegram(stream.at(500), stream.ipoc(500), 2);
  stream.reply(stream.at(500) + 4500us, stream.ipoc(500));
  stream.cycles(503, 1000, 50us);
  const Json json = json_of(monitor);
  CHECK(json["schema"] == "sweepd.link/1");
  CHECK(json["controller"] == "192.168.1.20");
  CHECK(json["server"] == "192.168.1.10:49152");
  CHECK(json["start"] == "2025-01-01T00:00:00.000Z");
  CHECK(json["duration_s"] == 3.996);
  CHECK(json["verdict"] == "marginal");
  REQUIRE(json["reasons"].size() == 5);
  CHECK(json["reasons"][0]["code"] == "late_at_controller");
  CHECK(json["reasons"][0]["grade"] == "marginal");
  CHECK(json["cycle_ms"] == 4.0);
  CHECK(json["ipoc_step"] == 4);
  CHECK(json["ipoc_counts_ms"] == true);

  const Json& telegrams = json["telegrams"];
  CHECK(telegrams["received"] == 998);
  CHECK(telegrams["lost"] == 2);
  CHECK(telegrams["late_replies"] == 2);
  CHECK(telegrams["worst_late_runs"] ==
        Json::parse(R"([{"replies": 2, "at_s": 2.0, "ipoc": 1002000}])"));
  CHECK(telegrams["longest_gap"] ==
        Json::parse(R"({"telegrams": 2, "at_s": 2.012, "ipoc": 1002012})"));
  const Json& replies = json["replies"];
  CHECK(replies["sent"] == 998);
  CHECK(replies["in_time"] == 997);
  CHECK(replies["late"] == 1);
  CHECK(replies["worst_runs_not_in_time"] ==
        Json::parse(R"([{"telegrams": 1, "at_s": 2.0, "ipoc": 1002000}])"));

  const Json& latency = json["latency"];
  CHECK(latency["count"] == 998);
  CHECK(latency["p50_us"].get<double>() == Approx(50).epsilon(1.0 / 128));
  CHECK(latency["max_us"] == 4500.0);
  CHECK(latency["slowest"][0] ==
        Json::parse(R"({"latency_us": 4500.0, "at_s": 2.0, "ipoc": 1002000})"));
  std::uint64_t sum = 0;
  for (const Json& bin : latency["histogram"]) sum += bin["count"].get<std::uint64_t>();
  CHECK(sum == 998);
  CHECK(json["jitter"]["latest_us"] == 0.0);
  CHECK(json["clock_steps"]["count"] == 0);
}

TEST_CASE("what was not seen is absent from the JSON", "[link_json]") {
  rsi::Link monitor;
  LinkStream stream(monitor);
  stream.telegram(0ms, 7, {});
  const Json json = json_of(monitor);
  for (const char* unknown : {"late_replies", "late_runs", "longest_late_run"}) {
    INFO(unknown);
    CHECK(json["telegrams"][unknown].is_null());
  }
  for (const char* absent : {"replies", "latency", "jitter", "cycle_ms"}) {
    INFO(absent);
    CHECK_FALSE(json.contains(absent));
  }
  REQUIRE(json["reasons"].size() == 2);
  CHECK(json["reasons"][0]["code"] == "few_telegrams");
  CHECK(json["reasons"][1]["code"] == "no_replies");
}

TEST_CASE("bins end at 1, 2 and 5 times a power of ten, from the first used to the last",
          "[link_json]") {
  rsi::LatencyHistogram histogram;
  CHECK(link_bins(histogram).empty());
  for (const auto duration : {12us, 19us, 30us, 150us}) histogram.add(duration);
  const auto bins = link_bins(histogram);
  REQUIRE(bins.size() == 4);
  CHECK((bins[0].from == 10us && bins[0].to == 20us && bins[0].count == 2));
  CHECK((bins[1].from == 20us && bins[1].to == 50us && bins[1].count == 1));
  CHECK((bins[2].from == 50us && bins[2].to == 100us && bins[2].count == 0));
  CHECK((bins[3].from == 100us && bins[3].to == 200us && bins[3].count == 1));
}

TEST_CASE("nothing is left out of the bins, from zero to the longest duration there is",
          "[link_json]") {
  rsi::LatencyHistogram histogram;
  histogram.add(0ns);
  histogram.add(std::chrono::nanoseconds::max());
  auto bins = link_bins(histogram);
  CHECK(bins.front().from == 0ns);
  CHECK(bins.front().to == 1us);
  CHECK(bins.back().count == 1);
  std::mt19937_64 random(5);
  for (int i = 0; i < 1000; ++i)
    histogram.add(std::chrono::nanoseconds(static_cast<std::int64_t>(random() >> (1 + i % 62))));
  std::uint64_t sum = 0;
  for (const auto& bin : link_bins(histogram)) sum += bin.count;
  CHECK(sum == 1002);
}
