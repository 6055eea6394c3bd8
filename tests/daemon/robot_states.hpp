#pragma once

#include "daemon/page/metrics.hpp"

namespace sweepd::test {

/// A robot that has streamed for a while, with numbers that differ from each other.
inline RobotState busy_robot(const std::string& name = "kr5-arc") {
  RobotState robot;
  robot.name = name;
  robot.listen = {0x7f000001, 49152};
  robot.stream = {"20250101T000000Z", std::chrono::seconds(1'735'689'600), 0xc0a80114,
                  std::chrono::milliseconds(4)};
  robot.verdict = LinkVerdict{rsi::Grade::bad, "the cable was out"};
  robot.sessions = 3;
  robot.server.answered = 1000;
  robot.server.foreign = 7;
  robot.server.unanswerable = 6;
  robot.server.not_begun = 5;
  robot.link.telegrams = 1010;
  robot.link.lost = 2;
  robot.link.in_time = 999;
  robot.link.late = 1;
  rsi::LatencyHistogram latency;
  for (int i = 0; i < 8; ++i) latency.add(std::chrono::microseconds(20));
  latency.add(std::chrono::microseconds(3500));
  latency.add(std::chrono::seconds(2));
  robot.link.latency.add(latency);
  robot.recording.bytes = 123'456;
  robot.recording.recorded = {2010, 1005};
  robot.recording.disk = {4, 2};
  robot.disk_free = 5'000'000'000;
  robot.sweeps[1] = {2, 1};
  robot.sweeps[6] = {1, 0};
  return robot;
}

inline ResultState one_result() {
  ResultState result;
  result.count = {1, 3, 2, 0};
  result.newest = {identify::Status::complete,
                   true,
                   "20250101T000000Z",
                   std::chrono::seconds(1'735'689'700),
                   std::chrono::milliseconds(250),
                   2,
                   std::make_shared<const std::string>("{\"schema\": \"sweepd.result/1\"}\n")};
  return result;
}

inline RobotMetrics metrics_of(RobotState state, ResultState result = {}) {
  return {std::make_shared<const RobotState>(std::move(state)),
          std::make_shared<const ResultState>(std::move(result))};
}

}  // namespace sweepd::test
