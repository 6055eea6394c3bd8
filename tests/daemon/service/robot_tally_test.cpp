#include "daemon/service/robot_tally.hpp"

#include "tests/catch.hpp"

using namespace std::chrono_literals;

namespace {

rsi::LinkReport report(std::uint64_t telegrams, std::uint64_t lost, int replies) {
  rsi::LinkReport report;
  report.link.telegrams = telegrams;
  report.link.lost = lost;
  report.replies.in_time = static_cast<std::uint64_t>(replies);
  report.cycle = 4ms;
  for (int i = 0; i < replies; ++i) report.latency.add(30us);
  return report;
}

/// All of it.
rsi::Link::Reports settled(const rsi::LinkReport& report) {
  return {report, report};
}

identify::Sweep sweep(std::optional<std::size_t> joint, identify::SweepDefect defect) {
  identify::Sweep sweep;
  sweep.joint = joint;
  sweep.defect = defect;
  return sweep;
}

sweepd::RobotState robot_state() {
  sweepd::RobotState robot;
  robot.name = "a";
  return robot;
}

sweepd::StreamState stream() {
  return {"20250101T000000Z", 1s, 0x7f000001};
}

}  // namespace

TEST_CASE("totals are those of all sessions, the one under way included", "[robot_tally]") {
  sweepd::RobotTally tally(robot_state());
  CHECK(tally.state({}, false, std::nullopt).link.telegrams == 0);
  CHECK_FALSE(tally.state({}, false, std::nullopt).stream);

  const auto first = std::make_shared<sweepd::Recording>();
  tally.begin_session(stream(), first);
  const auto under_way = settled(report(100, 1, 90));
  CHECK(tally.state({}, false, under_way).link.telegrams == 100);
  CHECK(tally.state({}, false, under_way).link.latency.count == 90);
  REQUIRE(tally.state({}, false, under_way).stream);
  CHECK(tally.state({}, false, under_way).stream->cycle == 4ms);
  tally.end_session(report(150, 1, 140));
  CHECK(tally.state({}, false, std::nullopt).link.telegrams == 150);
  CHECK_FALSE(tally.state({}, false, std::nullopt).stream);

  tally.begin_session(stream(), std::make_shared<sweepd::Recording>());
  const auto second = settled(report(10, 2, 10));
  const auto& state = tally.state({.answered = 77}, true, second);
  CHECK(state.name == "a");
  CHECK(state.sessions == 2);
  CHECK(state.link.telegrams == 160);
  CHECK(state.link.lost == 3);
  CHECK(state.link.in_time == 150);
  CHECK(state.link.latency.count == 150);
  CHECK(state.link.latency.sum == 150 * 30us);
  CHECK(state.link.latency.at_most.back() == 150);
  CHECK(state.server.answered == 77);
  CHECK(state.recording_paused);
}

TEST_CASE("the verdict is that of the stream, and stays behind it", "[robot_tally]") {
  sweepd::RobotTally tally(robot_state());
  CHECK_FALSE(tally.state({}, false, std::nullopt).verdict);
  tally.begin_session(stream(), std::make_shared<sweepd::Recording>());
  CHECK(tally.state({}, false, settled(report(10'000, 0, 10'000))).verdict->grade ==
        rsi::Grade::good);
  const auto bad = report(10'000, 500, 9500);
  CHECK(tally.state({}, false, settled(bad)).verdict->grade == rsi::Grade::bad);
  tally.end_session(bad);
  const auto verdict = tally.state({}, false, std::nullopt).verdict;
  REQUIRE(verdict);
  CHECK(verdict->grade == rsi::Grade::bad);
  CHECK_THAT(verdict->reason, Catch::Matchers::StartsWith("500 telegrams (4.76 %) never came"));
}

TEST_CASE("a count does not fall when a telegram that was taken for lost comes after all",
          "[robot_tally]") {
  sweepd::RobotTally tally(robot_state());
  tally.begin_session(stream(), std::make_shared<sweepd::Recording>());
  auto now = settled(report(10, 3, 5));
  CHECK(tally.state({}, false, now).link.lost == 3);
  now = settled(report(11, 2, 4));
  CHECK(tally.state({}, false, now).link.lost == 3);
  CHECK(tally.state({}, false, now).link.telegrams == 11);
  CHECK(tally.state({}, false, now).link.latency.count == 5);
  CHECK(tally.state({}, false, now).link.latency.at_most.back() == 5);
  now = settled(report(20, 4, 6));
  CHECK(tally.state({}, false, now).link.lost == 4);
}

TEST_CASE("what is not settled yet is told of the stream, and not counted", "[robot_tally]") {
  sweepd::RobotTally tally(robot_state());
  tally.begin_session(stream(), std::make_shared<sweepd::Recording>());
  rsi::Link::Reports now{report(100, 0, 90), report(100, 0, 30)};
  now.now.replies.late = 1;
  now.now.latency.add(7ms);
  const auto& state = tally.state({}, false, now);
  CHECK(state.link.late == 0);
  CHECK(state.link.in_time == 30);
  CHECK(state.link.latency.count == 30);
  CHECK(state.stream->latency_max >= 7ms);
}

TEST_CASE("recordings count until they are complete, also after their session", "[robot_tally]") {
  sweepd::RobotTally tally(robot_state());
  const auto first = std::make_shared<sweepd::Recording>();
  tally.begin_session(stream(), first);
  first->written({10, 5}, 1, 1000);
  CHECK(tally.state({}, false, std::nullopt).recording.bytes == 1000);
  tally.end_session({});
  const auto second = std::make_shared<sweepd::Recording>();
  tally.begin_session(stream(), second);
  second->written({1, 1}, 1, 100);
  first->written({20, 10}, 2, 2000);
  first->lost(sweepd::Missing::disk, {3, 1});
  CHECK(tally.state({}, false, std::nullopt).recording.bytes == 2100);
  first->finish();
  for (int round = 0; round < 2; ++round) {  // it is added once
    const auto& recording = tally.state({}, false, std::nullopt).recording;
    CHECK(recording.bytes == 2100);
    CHECK(recording.files == 3);
    CHECK(recording.recorded == sweepd::RecordCount{21, 11});
    CHECK(recording.disk == sweepd::RecordCount{3, 1});
  }
  CHECK(first.use_count() == 1);  // and let go
}

TEST_CASE("sweeps are counted by joint, from 1, and by what they are good for", "[robot_tally]") {
  using identify::SweepDefect;
  sweepd::RobotTally tally(robot_state());
  tally.sweep(sweep(0, SweepDefect::none), "words");
  tally.sweep(sweep(0, SweepDefect::none), "words");
  tally.sweep(sweep(0, SweepDefect::too_short), "words");
  tally.sweep(sweep(5, SweepDefect::none), "words");
  tally.sweep(sweep(std::nullopt, SweepDefect::not_an_arc), "words");
  const auto sweeps = tally.state({}, false, std::nullopt).sweeps;
  REQUIRE(sweeps.size() == 3);
  CHECK(sweeps.at(1).usable == 2);
  CHECK(sweeps.at(1).not_usable == 1);
  CHECK(sweeps.at(6).usable == 1);
  CHECK(sweeps.at(0).not_usable == 1);
}
