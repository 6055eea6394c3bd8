// The link report on telegrams that were recorded on a KR C4 whose replies came late now and then.

#include <algorithm>
#include <iostream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/commands/inspect_command.hpp"
#include "tests/acceptance/acceptance.hpp"
#include "tests/acceptance/recording.hpp"
#include "tests/catch.hpp"

using namespace acceptance;
using Json = nlohmann::json;

namespace {

/// What stands in `line` between `before` and the next quotation mark or tag.
std::uint64_t number_after(std::string_view line, std::string_view before) {
  const auto begin = line.find(before) + before.size();
  return static_cast<std::uint64_t>(
      number(line.substr(begin, line.find_first_of("\"<", begin) - begin)));
}

struct LateRun {
  std::uint64_t replies = 0;
  std::uint64_t ipoc = 0;
  std::size_t telegram = 0;
};

/// Runs of telegrams with a Delay above zero, found without sweepd.
std::vector<LateRun> late_runs(const std::vector<std::string>& lines) {
  std::vector<LateRun> runs;
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto delay = number_after(lines[i], "<Delay D=\"");
    if (delay > 0 && before == 0) runs.push_back({0, number_after(lines[i], "<IPOC>"), i});
    if (delay > 0) runs.back().replies = std::max(runs.back().replies, delay);
    before = delay;
  }
  return runs;
}

}  // namespace

TEST_CASE("The link report of a recording shows each run of late replies in its place",
          "[inspect]") {
  const auto folder = real_data("recordings");
  if (!folder) return;
  const TemporaryFolder temporary;
  const auto recording = *folder / "a1-late-packets.txt";
  recording_to_capture(recording, temporary / "recording.pcap");
  std::ostringstream out;
  std::ostringstream errors;
  // Late now and then, never for long: the controller went on.
  REQUIRE(
      sweepd::inspect({.traces = {temporary / "recording.pcap"}, .json = temporary / "link.json"},
                      out, errors) == 0);
  CHECK(errors.str().empty());
  std::cout << out.str() << '\n';
  const Json link = Json::parse(text_of(temporary / "link.json"));

  auto expected = late_runs(lines_of(recording));
  REQUIRE(expected.size() == 9);
  std::stable_sort(expected.begin(), expected.end(),
                   [](const auto& a, const auto& b) { return a.replies > b.replies; });
  const Json& telegrams = link["telegrams"];
  CHECK(telegrams["received"] == 6523);
  CHECK(telegrams["lost"] == 0);
  CHECK(telegrams["late_replies"] == 11);
  CHECK(telegrams["late_runs"] == 9);
  CHECK(telegrams["longest_late_run"] == 2);
  REQUIRE(telegrams["worst_late_runs"].size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Json& run = telegrams["worst_late_runs"][i];
    INFO(run);
    CHECK(run["replies"] == expected[i].replies);
    CHECK(run["ipoc"] == expected[i].ipoc);
    CHECK(run["at_s"].get<double>() ==
          Approx(0.004 * static_cast<double>(expected[i].telegram)).margin(1e-9));
    CHECK_THAT(out.str(), Catch::Matchers::ContainsSubstring(std::to_string(expected[i].ipoc)));
  }
  CHECK(link["verdict"] == "marginal");
  REQUIRE(link["reasons"].size() == 1);
  CHECK(link["reasons"][0]["code"] == "late_at_controller");
  CHECK(link["cycle_ms"] == 4.0);
  CHECK_FALSE(link.contains("replies"));
}
