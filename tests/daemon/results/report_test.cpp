#include "daemon/results/report.hpp"

#include <algorithm>
#include <limits>
#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/results/result_formats.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/outcomes.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::report;
using namespace sweepd::test;

namespace {

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) all.push_back(line);
  return all;
}

/// Columns on a terminal: characters of UTF-8, not bytes.
std::size_t width(const std::string& line) {
  return static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

void check_layout(const std::string& text) {
  CHECK(text.ends_with("\n"));
  std::size_t header = 0;  // width of the table that we are in; 0: in none
  for (const auto& line : lines(text)) {
    INFO(line);
    CHECK(width(line) <= 80);
    CHECK_FALSE(line.ends_with(" "));
    if (line.starts_with("joint ")) header = width(line);
    if (line.empty()) header = 0;
    if (header > 0) CHECK(width(line) <= header);
  }
}

/// The text with its line breaks as single blanks, as it is read.
std::string flowing(const std::string& text) {
  std::string words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) words += (words.empty() ? "" : " ") + word;
  return words;
}

}  // namespace

TEST_CASE("every report fits 80 columns, and no row is wider than its table", "[report][long]") {
  check_layout(report(complete_outcome()));
  check_layout(report(partial_outcome()));
  check_layout(report(failed_outcome()));
  check_layout(report(unspecified_outcome()));
  check_layout(report({.robot = "kr5-arc", .counts = {}, .identification = {}}));
}

TEST_CASE("numbers of one table line up with their header", "[report]") {
  const auto all = lines(report(complete_outcome()));
  const auto header = std::find_if(all.begin(), all.end(), [](const std::string& line) {
    return line.find("specified") != std::string::npos && line.starts_with("joint");
  });
  REQUIRE(header != all.end());
  std::size_t rows = 0;
  for (const auto& line : all)
    if (line.find("b      mm ") != std::string::npos ||
        line.find("a      mm ") != std::string::npos) {
      INFO(line);
      CHECK(line.size() == header->size());
      ++rows;
    }
  CHECK(rows == 12);  // b and a of six joints
}

TEST_CASE("a complete report has the robot, its table beside the specified one, and the box",
          "[report]") {
  const auto text = report(complete_outcome());
  CHECK_THAT(text, ContainsSubstring("kr5-arc") && ContainsSubstring("complete") &&
                       ContainsSubstring("one every 4 ms"));
  CHECK_THAT(text, ContainsSubstring("identified") && ContainsSubstring("specified") &&
                       ContainsSubstring("difference"));
  CHECK_THAT(text, ContainsSubstring("620.0000") && ContainsSubstring("parallel") &&
                       ContainsSubstring("(set)"));
  CHECK_THAT(text, ContainsSubstring("Smallest box"));
  CHECK_THAT(text, ContainsSubstring("Tz(b) Rz(theta) Tx(a) Rx(alpha)") &&
                       ContainsSubstring("theta is the"));
}

TEST_CASE("what is not compared says why", "[report]") {
  auto outcome = complete_outcome();
  CHECK_THAT(report(outcome), !ContainsSubstring("not compared"));
  outcome.identification.home_rad[3].reset();
  check_layout(report(outcome));
  CHECK_THAT(flowing(report(outcome)),
             ContainsSubstring("theta -: not compared, since the controller's angles at home are "
                               "not known: give --plan, or angles."));
}

TEST_CASE("a complete report shows the chain beside the circles, and how far angles are believed",
          "[report]") {
  const auto text = report(complete_outcome());
  CHECK_THAT(text, ContainsSubstring("DH parameters by the chain estimator") &&
                       ContainsSubstring("circle") && ContainsSubstring("beta   deg") &&
                       ContainsSubstring("trusted") && ContainsSubstring("backlash"));
  CHECK_THAT(flowing(text), ContainsSubstring("samples, 0 outliers, position noise") &&
                                ContainsSubstring("converged, after"));
}

TEST_CASE("axes that were given have their table and no word of circles or fits", "[report]") {
  auto outcome = complete_outcome();
  outcome.identification.estimator = identify::Estimator::axes;
  outcome.identification.chain.reset();
  outcome.identification.bounding_box.reset();
  CHECK_THAT(report(outcome), ContainsSubstring("DH parameters of the given axes") &&
                                  !ContainsSubstring("circle") && !ContainsSubstring("fit  "));
}

TEST_CASE("what a device measured is told to be in its own scale, a controller's model is not",
          "[report]") {
  sweepd::Outcome outcome = complete_outcome();
  CHECK_THAT(flowing(report(outcome)), !ContainsSubstring("scale"));
  outcome.points = sweepd::PointCounts{};
  for (identify::AngleEvidence& joint : outcome.identification.chain->angles)
    joint.trust = identify::AngleTrust::free;
  const std::string told =
      "The device's own scale is not in the uncertainties: where it is off by 0.01 %, a length of "
      "1 m is off by 0.1 mm";
  CHECK_THAT(flowing(report(outcome)),
             ContainsSubstring(told) && !ContainsSubstring("joints play by"));
  CHECK_THAT(nlohmann::json::parse(sweepd::result_json(outcome))["explanation"].get<std::string>(),
             ContainsSubstring(told));
  for (identify::AngleEvidence& joint : outcome.identification.chain->angles) joint.samples = 0;
  CHECK_THAT(flowing(report(outcome)),
             ContainsSubstring("What joints play by is not in the uncertainties"));
}

TEST_CASE("a doubtful report says every doubt before anything else", "[report]") {
  auto outcome = partial_outcome();
  const std::string missing = outcome.identification.reason;
  outcome.identification.doubts = {{"frame_mirrored", {}, "the frame is mirrored"},
                                   {"circle_misfit", 2, "joint 3: no circle"}};
  identify::apply_doubts(outcome.identification);
  const auto text = flowing(report(outcome));
  CHECK_THAT(text, ContainsSubstring("doubtful: the frame is mirrored; " + missing +
                                     " and joint 3: no circle telegrams"));
}

TEST_CASE("a partial report names the reason and every warning, whole", "[report]") {
  const auto outcome = partial_outcome();
  const auto text = flowing(report(outcome));
  CHECK_THAT(text, ContainsSubstring("partial: " + outcome.identification.reason));
  REQUIRE_FALSE(outcome.identification.warnings.empty());
  for (const auto& warning : outcome.identification.warnings)
    CHECK_THAT(text, ContainsSubstring(flowing(warning.message)) &&
                         ContainsSubstring("[" + warning.code + "]"));
}

TEST_CASE("a failed report names the reason and shows no table of nothing", "[report]") {
  const auto outcome = failed_outcome();
  const auto text = report(outcome);
  CHECK_THAT(flowing(text), ContainsSubstring("failed: " + outcome.identification.reason));
  CHECK_THAT(text, Catch::Matchers::StartsWith("robot "));  // there is nothing to describe
  CHECK_THAT(text, !ContainsSubstring("identified") && !ContainsSubstring("Smallest box"));
}

TEST_CASE("without a specified table there is no column for it", "[report]") {
  CHECK_THAT(report(complete_outcome()),
             ContainsSubstring(" specified ") && ContainsSubstring(" difference"));
  CHECK_THAT(report(unspecified_outcome()),
             !ContainsSubstring("specified") && !ContainsSubstring("difference"));
}

TEST_CASE("a report says the cycle as it was measured, and what it does not know of late replies",
          "[report][issue11][point_15]") {
  auto outcome = failed_outcome();
  outcome.counts.cycle = std::chrono::microseconds(4003);
  CHECK_THAT(flowing(report(outcome)),
             ContainsSubstring("one every 4.003 ms") &&
                 ContainsSubstring("replies how many were late is not known"));
  outcome.counts.cycle = std::chrono::milliseconds(12);
  outcome.counts.link.late_replies = 1;
  outcome.counts.link.late_runs = outcome.counts.link.longest_late_run = 1;
  CHECK_THAT(flowing(report(outcome)),
             ContainsSubstring("one every 12 ms") &&
                 ContainsSubstring("late at controller 1, in 1 run of at most 1"));
}

TEST_CASE("what the status says is no warning besides, and nothing swept is no table", "[report]") {
  auto outcome = failed_outcome();
  outcome.identification.reason = "10 poses give 30 rows: measure more";
  outcome.identification.warnings = {{"poses_not_used", {}, outcome.identification.reason}};
  for (auto& joint : outcome.identification.joints) joint.sweeps.clear();
  const auto text = report(outcome);
  CHECK_THAT(text, ContainsSubstring("10 poses give 30 rows") && !ContainsSubstring("Warnings") &&
                       !ContainsSubstring("joint  sweeps"));
}

TEST_CASE("long texts, large counts, odd numbers and twelve joints fit as well", "[report]") {
  auto outcome = partial_outcome();
  auto& found = outcome.identification;
  found.reason =
      "a reason of very many words that goes on and on until it is far longer than any "
      "terminal is wide, and then some";
  found.warnings.push_back({"long_one", 1, found.reason + ", " + found.reason});
  found.home_rad.assign(12, -3.14159);
  outcome.counts.link.telegrams = std::numeric_limits<std::uint64_t>::max();
  outcome.counts.link.late_replies = 123'456'789;
  outcome.counts.link.late_runs = 123'456'789;
  outcome.counts.link.longest_late_run = 123'456'789;
  outcome.counts.unusable_values = 123'456'789;
  check_layout(report(outcome));
  CHECK_THAT(flowing(report(outcome)),
             ContainsSubstring(found.reason + ", " + found.reason + " [long_one]"));
}

TEST_CASE("a sweep is told as it happens: joint, direction, range, time, samples", "[report]") {
  const auto outcome = complete_outcome();
  const auto& sweeps = outcome.identification.joints[0].sweeps;
  REQUIRE(sweeps.size() == 3);
  CHECK_THAT(sweepd::sweep_line(sweeps[1]),
             Catch::Matchers::StartsWith("joint 1: ") && ContainsSubstring("+") &&
                 ContainsSubstring(" deg in ") && ContainsSubstring(" samples"));
  CHECK_THAT(sweepd::sweep_line(sweeps[0]), ContainsSubstring("-1"));  // from 90 to -45 degrees
  auto unknown = sweeps[1];
  unknown.joint.reset();
  unknown.direction = 0;
  CHECK_THAT(sweepd::sweep_line(unknown),
             Catch::Matchers::StartsWith("a joint: ") && !ContainsSubstring("+"));
}
