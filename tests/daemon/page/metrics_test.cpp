#include "daemon/page/metrics.hpp"

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

#include "tests/catch.hpp"
#include "tests/daemon/robot_states.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::test::busy_robot;
using sweepd::test::metrics_of;
using sweepd::test::one_result;

namespace {

std::string metrics_text(const std::vector<sweepd::RobotMetrics>& robots) {
  sweepd::ServiceStatus status;
  status.phase = sweepd::ServiceStatus::Phase::serving;
  return sweepd::metrics(status, robots,
                         {std::chrono::seconds(1000), std::chrono::milliseconds(1500), 4096, 12});
}

std::string busy_text() {
  return metrics_text({metrics_of(busy_robot(), one_result()), metrics_of(busy_robot("b"))});
}

/// What a scraper reads: families with their types, and values by name and labels.
struct Scrape {
  std::map<std::string, std::string> types;
  std::map<std::string, double> values;
};

/// Fails at whatever breaks a rule of the format.
Scrape scrape(const std::string& text) {
  Scrape scrape;
  std::set<std::string> closed;  // families that have ended
  std::string family;
  std::string helped;
  std::istringstream lines(text);
  REQUIRE(text.back() == '\n');
  for (std::string line; std::getline(lines, line);) {
    INFO(line);
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "#") {
      std::string keyword, name, type;
      words >> keyword >> name >> type;
      if (keyword == "HELP") {
        helped = name;
      } else {
        REQUIRE(keyword == "TYPE");
        CHECK(helped == name);  // HELP goes before
        closed.insert(family);
        CHECK_FALSE(closed.contains(name));
        family = name;
        CHECK(scrape.types.emplace(name, type).second);
        CHECK((type == "counter") == name.ends_with("_total"));
      }
      continue;
    }
    const auto end = line.rfind(' ');
    const std::string key = line.substr(0, end);
    std::string name = key.substr(0, key.find('{'));
    CHECK(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == name.npos);
    if (scrape.types[family] == "histogram")
      for (const std::string suffix : {"_bucket", "_sum", "_count"})
        if (name.ends_with(suffix)) name.erase(name.size() - suffix.size());
    CHECK(name == family);
    std::istringstream value(line.substr(end + 1));
    double number = -1;
    REQUIRE(value >> number);
    CHECK(value.eof());
    CHECK(scrape.values.emplace(key, number).second);
  }
  return scrape;
}

}  // namespace

TEST_CASE("metrics keep to the text format: a family at a time, each value once", "[metrics]") {
  const auto all = scrape(busy_text());
  CHECK(all.types.at("sweepd_telegrams_total") == "counter");
  CHECK(all.types.at("sweepd_reply_latency_seconds") == "histogram");
  CHECK(all.values.at("sweepd_telegrams_total{robot=\"kr5-arc\"}") == 1010);
  CHECK(all.values.at("sweepd_telegrams_lost_total{robot=\"b\"}") == 2);
  CHECK(all.values.at("sweepd_telegrams_answered_total{robot=\"b\",outcome=\"in_time\"}") == 999);
  CHECK(all.values.at("sweepd_replies_total{robot=\"b\"}") == 1000);
  CHECK(all.values.at("sweepd_datagrams_dropped_total{robot=\"b\",reason=\"foreign\"}") == 7);
  CHECK(all.values.at("sweepd_datagrams_without_ipoc_total{robot=\"b\"}") == 6);
  CHECK(all.values.at("sweepd_reply_failures_total{robot=\"b\",reason=\"stream_not_begun\"}") == 5);
  CHECK(all.values.at("sweepd_streaming{robot=\"b\"}") == 1);
  CHECK(all.values.at("sweepd_cycle_seconds{robot=\"b\"}") == 0.004);
  CHECK(all.values.at("sweepd_recording_bytes_total{robot=\"b\"}") == 123'456);
  CHECK(all.values.at("sweepd_recording_missed_samples_total{robot=\"b\",reason=\"disk\"}") == 2);
  CHECK(all.values.at("sweepd_sweeps_total{robot=\"b\",joint=\"1\",usable=\"false\"}") == 1);
  CHECK(all.values.at("sweepd_identifications_total{robot=\"kr5-arc\",status=\"partial\"}") == 2);
  CHECK(all.values.at("sweepd_identifications_total{robot=\"kr5-arc\",status=\"doubtful\"}") == 3);
  CHECK(all.values.at("sweepd_result_duration_seconds{robot=\"kr5-arc\"}") == 0.25);
  CHECK(all.values.at("sweepd_result_timestamp_seconds{robot=\"kr5-arc\"}") == 1'735'689'700);
  CHECK(all.values.at("sweepd_result_status{robot=\"kr5-arc\",status=\"complete\"}") == 1);
  CHECK(all.values.at("sweepd_result_status{robot=\"kr5-arc\",status=\"doubtful\"}") == 0);
  CHECK(all.values.at("sweepd_result_interim{robot=\"kr5-arc\"}") == 1);
  CHECK(all.values.at("sweepd_disk_free_bytes{robot=\"b\"}") == 5'000'000'000);
  CHECK(all.values.at("process_start_time_seconds") == 1000);
  CHECK(all.values.at("process_cpu_seconds_total") == 1.5);
  CHECK(all.values.at("sweepd_ready") == 1);
  SECTION("of what is not there nothing is said") {
    CHECK_FALSE(all.values.contains("sweepd_result_duration_seconds{robot=\"b\"}"));
    CHECK_FALSE(all.values.contains("sweepd_result_status{robot=\"b\",status=\"complete\"}"));
    CHECK_FALSE(scrape(metrics_text({metrics_of({})}))
                    .values.contains("sweepd_disk_free_bytes{robot=\"\"}"));
    CHECK_FALSE(
        scrape(metrics_text({metrics_of({})})).values.contains("sweepd_cycle_seconds{robot=\"\"}"));
  }
}

TEST_CASE("replies that a controller missed have no value where its telegrams carry no Delay",
          "[metrics][issue11][point_15]") {
  auto tells = busy_robot("b");
  tells.link.missed_by_controller = 3;
  const auto all = scrape(metrics_text({metrics_of(busy_robot()), metrics_of(tells)}));
  CHECK(all.values.at("sweepd_controller_missed_replies_total{robot=\"b\"}") == 3);
  CHECK_FALSE(all.values.contains("sweepd_controller_missed_replies_total{robot=\"kr5-arc\"}"));
}

TEST_CASE("the buckets of a histogram add up, and the last one holds all", "[metrics]") {
  const auto all = scrape(busy_text());
  const std::string name = "sweepd_reply_latency_seconds";
  const auto bucket = [&](const std::string& limit) {
    return all.values.at(name + "_bucket{robot=\"b\",le=\"" + limit + "\"}");
  };
  CHECK(bucket("1e-05") == 0);
  CHECK(bucket("2.5e-05") == 8);
  CHECK(bucket("0.003") == 8);
  CHECK(bucket("0.004") == 9);
  CHECK(bucket("0.012") == 9);
  CHECK(bucket("1") == 9);
  CHECK(bucket("+Inf") == 10);
  CHECK(all.values.at(name + "_count{robot=\"b\"}") == 10);
  CHECK(all.values.at(name + "_sum{robot=\"b\"}") == Approx(8 * 20e-6 + 3500e-6 + 2));
}

TEST_CASE("labels are escaped", "[metrics]") {
  const auto all = metrics_text({metrics_of(busy_robot("a\"b\\c\nd"))});
  CHECK_THAT(all, ContainsSubstring("sweepd_telegrams_total{robot=\"a\\\"b\\\\c\\nd\"} 1010\n"));
}

TEST_CASE("without a robot there are still metrics of the program", "[metrics]") {
  CHECK(scrape(metrics_text({}))
            .values.contains("sweepd_build_info{version=\"" SWEEPD_VERSION "\"}"));
}

// Prometheus's own checker, from Debian's package `prometheus`.
TEST_CASE("promtool has nothing to say about the metrics", "[metrics][promtool]") {
  const char* given = std::getenv("SWEEPD_PROMTOOL");
  const std::string promtool = given ? given : "promtool";
  if (std::system((promtool + " --version >/dev/null 2>&1").c_str()) != 0) {
    std::cout << "not available here: promtool\n";
    return;
  }
  const sweepd::test::TemporaryFolder folder;
  const auto check = [&](const std::string& metrics) {
    std::ofstream(folder / "metrics") << metrics;
    const auto command = promtool + " check metrics <" + (folder / "metrics").string() + " >" +
                         (folder / "said").string() + " 2>&1";
    const int code = std::system(command.c_str());
    return std::pair(code, sweepd::test::content(folder / "said"));
  };
  CHECK(check(busy_text()) == std::pair(0, std::string()));
  CHECK(check(metrics_text({metrics_of({})})) == std::pair(0, std::string()));
  CHECK(check("# TYPE wrong counter\nwrong 1\n").first != 0);
}

TEST_CASE("a robot that cannot be served has a metric, and so have lost lines of the log",
          "[metrics][issue11][point_5][point_7]") {
  sweepd::ServiceStatus status;
  status.phase = sweepd::ServiceStatus::Phase::serving;
  status.not_served = {{"far", "cannot listen"}};
  const auto text = sweepd::metrics(status, {metrics_of(busy_robot("near"))}, {{}, {}, 0, 12});
  CHECK_THAT(text, ContainsSubstring("\nsweepd_ready 0\n"));
  CHECK_THAT(text, ContainsSubstring("\nsweepd_robot_served{robot=\"near\"} 1\n"
                                     "sweepd_robot_served{robot=\"far\"} 0\n"));
  CHECK_THAT(text, ContainsSubstring("\nsweepd_log_lines_lost_total 12\n"));
}
