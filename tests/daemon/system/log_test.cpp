#include "daemon/system/log.hpp"

#include "daemon/system/log_repeats.hpp"
#include "tests/catch.hpp"

using namespace std::chrono_literals;
using sweepd::Importance;
using sweepd::LogLine;
using sweepd::LogRepeats;

namespace {

const LogRepeats::Time kFirstLine{};

LogLine line(const std::string& text, const std::string& robot = "arc") {
  return {Importance::warning, {robot}, text};
}

std::vector<std::string> texts(const std::vector<LogLine>& lines) {
  std::vector<std::string> all;
  for (const auto& each : lines) all.push_back(each.message());
  return all;
}

}  // namespace

TEST_CASE("a line has priority, robot, session and IPOC as fields of the journal", "[log]") {
  using Fields = std::vector<std::string>;
  CHECK(sweepd::journal_fields(
            {Importance::error, {"arc", "20261121T090000Z", "1525084"}, "no room"}) ==
        Fields{"MESSAGE=arc: no room", "PRIORITY=3", "SYSLOG_IDENTIFIER=sweepd", "SWEEPD_ROBOT=arc",
               "SWEEPD_SESSION=20261121T090000Z", "SWEEPD_IPOC=1525084"});
  CHECK(sweepd::journal_fields({Importance::note, {}, "ending"}) ==
        Fields{"MESSAGE=ending", "PRIORITY=6", "SYSLOG_IDENTIFIER=sweepd"});
  CHECK(sweepd::journal_fields(line("slow"))[1] == "PRIORITY=4");
}

TEST_CASE("a line is said once a minute, and then how often it came meanwhile", "[log]") {
  LogRepeats repeats;
  CHECK(repeats.is_new(line("RSI from 10.0.0.2"), kFirstLine));
  for (int i = 0; i < 18; ++i)
    CHECK_FALSE(repeats.is_new(line("RSI from 10.0.0.2"), kFirstLine + i * 1s));
  CHECK(repeats.due(kFirstLine + 59s).empty());
  CHECK(texts(repeats.due(kFirstLine + 60s)) ==
        std::vector<std::string>{"arc: RSI from 10.0.0.2 (18 times more within a minute)"});

  // The count has begun anew, and what stays away is forgotten.
  CHECK_FALSE(repeats.is_new(line("RSI from 10.0.0.2"), kFirstLine + 61s));
  CHECK(texts(repeats.due(kFirstLine + 120s)) ==
        std::vector<std::string>{"arc: RSI from 10.0.0.2 (once more within a minute)"});
  CHECK(repeats.due(kFirstLine + 180s).empty());
  CHECK(repeats.is_new(line("RSI from 10.0.0.2"), kFirstLine + 181s));
}

TEST_CASE("a note tells of an event: one like another is said when it happens",
          "[log][issue11][point_20]") {
  LogRepeats repeats;
  LogLine sweep = line("joint 1: sweep of +90.0 deg in 4.50 s, 1125 samples");
  sweep.importance = Importance::note;
  for (int i = 0; i < 3; ++i) CHECK(repeats.is_new(sweep, kFirstLine + i * 1s));
  CHECK(repeats.all().empty());
}

TEST_CASE("other lines, and those of other robots, are no repeats", "[log]") {
  LogRepeats repeats;
  CHECK(repeats.is_new(line("result complete"), kFirstLine));
  CHECK(repeats.is_new(line("result partial"), kFirstLine));
  CHECK(repeats.is_new(line("result complete", "other"), kFirstLine));
  CHECK(repeats.all().empty());
}

TEST_CASE("what was held back is said at the end, with what the newest was about", "[log]") {
  LogRepeats repeats;
  CHECK(repeats.is_new(line("late"), kFirstLine));
  LogLine newest = line("late");
  newest.subject.ipoc = "42";
  CHECK_FALSE(repeats.is_new(newest, kFirstLine + 1s));
  const auto all = repeats.all();
  REQUIRE(all.size() == 1);
  CHECK(all[0].subject.ipoc == "42");
  CHECK(all[0].importance == Importance::warning);
  CHECK(repeats.all().empty());
}

TEST_CASE("a flood of different lines is said and not remembered", "[log]") {
  LogRepeats repeats;
  for (int i = 0; i < 5000; ++i) CHECK(repeats.is_new(line(std::to_string(i)), kFirstLine));
  CHECK(repeats.is_new(line("4999"), kFirstLine));  // beyond what is remembered
  CHECK_FALSE(repeats.is_new(line("0"), kFirstLine));
}
