#include "daemon/page/live_stream.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "daemon/service/live_feed.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/robot_states.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using sweepd::LiveSlice;
using sweepd::LiveSlices;
using sweepd::LiveStream;
using Events = std::vector<std::pair<std::string, nlohmann::ordered_json>>;

namespace {

/// As a browser reads it: each event's name and data.
Events events_in(std::string_view text) {
  Events events;
  std::string event, data;
  while (!text.empty()) {
    const auto line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.starts_with("event: ")) event = line.substr(7);
    if (line.starts_with("data: ")) data = line.substr(6);
    if (!line.empty() || event.empty()) continue;
    events.emplace_back(std::exchange(event, {}), nlohmann::ordered_json::parse(data));
  }
  return events;
}

std::vector<std::string> names(const Events& events) {
  std::vector<std::string> all;
  for (const auto& [event, data] : events) all.push_back(event);
  return all;
}

/// A robot that streams: a slice whenever it is told to.
struct StreamingRobot {
  std::shared_ptr<sweepd::RobotStatus> robot = std::make_shared<sweepd::RobotStatus>();
  sweepd::Published<sweepd::ServiceStatus> status;
  LiveSlice slice;
  std::uint64_t sweeps = 0;

  explicit StreamingRobot(const sweepd::ResultState& result = {}) {
    robot->state.publish(sweepd::test::busy_robot());
    robot->result.publish(result);
    sweepd::RobotFacts facts{2, {{400, 0.5, 180, 0.25}, {}}, {90, -90}, {{-155, 155}, {}}};
    robot->facts.publish(facts);
    slice.session = 1;
    slice.joints = 2;
    publish();
  }
  void publish() {
    sweepd::ServiceStatus serving{sweepd::ServiceStatus::Phase::serving, {robot}, {}, {}};
    status.publish(serving);
  }
  void add(int slices, int sweeps_with_them = 0) {
    std::vector<std::shared_ptr<const sweepd::LiveSweep>> seen;
    for (int i = 0; i < sweeps_with_them; ++i) {
      auto sweep = std::make_shared<sweepd::LiveSweep>();
      sweep->number = ++sweeps;
      sweep->session = slice.session;
      sweep->joint = 2;
      sweep->start_s = 1.25;
      sweep->range = 89.9903;
      sweep->words = "joint 2 </script>";
      seen.push_back(sweep);
    }
    for (int i = 0; i < slices; ++i) {
      ++slice.number;
      slice.at_s += 0.1;
      slice.count = 1;
      slice.points[0] = {slice.at_s, true, {1, 2, 3}, {10, 20}};
      CHECK(robot->live.try_add(slice, std::exchange(seen, {})));
    }
  }
};

std::size_t slices_in(const Events& events) {
  std::size_t count = 0;
  for (const auto& [event, data] : events)
    if (event == "cycles") count += data["at_s"].size();
  return count;
}

}  // namespace

TEST_CASE("a viewer is told the robot first, then the last minute, then what is new",
          "[live_stream]") {
  StreamingRobot robot(sweepd::test::one_result());
  robot.add(700, 1);
  LiveStream stream(robot.status, robot.robot);
  const auto text = stream.next();
  REQUIRE(text);
  CHECK_THAT(*text, StartsWith("retry: 1000\n\nevent: hello\n"));
  CHECK_THAT(*text, ContainsSubstring("\nid: 700\n"));
  const auto events = events_in(*text);
  CHECK(names(events) ==
        std::vector<std::string>{"hello", "link", "samples", "cycles", "sweep", "result"});
  const auto& hello = events[0].second;
  CHECK(hello["schema"] == "sweepd.live/1");
  CHECK(hello["robot"] == "kr5-arc");
  CHECK(hello["joints"] == 2);
  CHECK(hello["describes"] == "controller_model");
  CHECK(hello["specified"][0]["b_mm"] == "400.0");
  CHECK(hello["home"][1] == -90);
  CHECK(hello["limits"][0]["max"] == 155);
  CHECK(hello["limits"][1]["max"].is_null());
  CHECK(events[1].second["telegrams"]["received"] == 1010);
  CHECK(slices_in(events) == 600);
  CHECK(events[2].second["angles"][0] == nlohmann::ordered_json{10.0, 20.0});
  CHECK(events[4].second["range"] == "89.9903");
  CHECK(events[4].second["words"] == "joint 2 </script>");

  CHECK(stream.next()->empty());
  robot.add(2);
  CHECK(names(events_in(*stream.next())) == std::vector<std::string>{"samples", "cycles"});
  robot.robot->state.publish(sweepd::test::busy_robot());
  CHECK(names(events_in(*stream.next())) == std::vector<std::string>{"link"});
}

TEST_CASE("who is slow misses slices and is told how many, others miss none", "[live_stream]") {
  StreamingRobot robot;
  robot.add(1);
  LiveStream slow(robot.status, robot.robot), quick(robot.status, robot.robot);
  static_cast<void>(slow.next());
  static_cast<void>(quick.next());
  std::size_t seen = 0;
  for (int i = 0; i < 50; ++i) {
    robot.add(1);
    const auto events = events_in(*quick.next());
    CHECK(names(events).front() != "gap");
    seen += slices_in(events);
  }
  CHECK(seen == 50);
  const auto events = events_in(*slow.next());
  REQUIRE(events.front().first == "gap");
  CHECK(events.front().second["missed"] == 50 - LiveStream::kMostBehind);
  CHECK(slices_in(events) == LiveStream::kMostBehind);
}

TEST_CASE("slices of different sessions come apart, and earlier sweeps go", "[live_stream]") {
  StreamingRobot robot;
  robot.add(3, 2);
  robot.slice.session = 2;
  robot.add(2, 1);
  LiveStream stream(robot.status, robot.robot);
  const auto events = events_in(*stream.next());
  std::vector<int> sessions;
  for (const auto& [event, data] : events)
    if (event == "samples" || event == "sweep") sessions.push_back(data["session"]);
  CHECK(sessions == std::vector<int>{1, 2, 2});
}

TEST_CASE("a result's numbers keep their digits", "[live_stream]") {
  auto result = sweepd::test::one_result();
  result.newest->json = std::make_shared<const std::string>(
      R"({"describes": "controller_model", "dh": [{"joint": 1, "b_mm": 400.0, "b_sigma_mm": 6.6e-05,
          "a_mm": null, "by_convention": ["a_mm"]}], "warnings": [{"code": "x", "message": "<b>"}],
          "joints": [{"joint": 1, "sweeps": [{"start_s": 0.184, "range_deg": 29.9903,
          "used": true}]}], "covariance": {"rows": [[1]]}})");
  StreamingRobot robot(result);
  LiveStream stream(robot.status, robot.robot);
  const auto told = events_in(*stream.next()).back();
  CHECK(told.first == "result");
  CHECK(told.second["dh"][0]["b_mm"] == "400.0");
  CHECK(told.second["dh"][0]["b_sigma_mm"] == "6.6e-05");
  CHECK(told.second["dh"][0]["a_mm"].is_null());
  CHECK(told.second["dh"][0]["by_convention"][0] == "a_mm");
  CHECK(told.second["sweeps"][0]["start_s"] == "0.184");
  CHECK(told.second["sweeps"][0]["used"] == true);
  CHECK(told.second["sweeps"][0]["joint"] == 1);
  CHECK(told.second["warnings"][0]["message"] == "<b>");
  CHECK_FALSE(told.second.contains("covariance"));
  SECTION("what is no JSON is not told") {
    result.newest->json = std::make_shared<const std::string>("{");
    robot.robot->result.publish(result);
    CHECK(events_in(*stream.next()).back().second["status"] == "complete");
  }
}

TEST_CASE("the stream ends with the robot, and somebody looks only as long", "[live_stream]") {
  StreamingRobot robot;
  CHECK_FALSE(robot.robot->live.watched());
  {
    LiveStream stream(robot.status, robot.robot);
    CHECK(robot.robot->live.watched());
    CHECK(stream.next());
    robot.status.publish({});
    CHECK_FALSE(stream.next());
  }
  CHECK_FALSE(robot.robot->live.watched());
}
