#include "daemon/service/service_status.hpp"

#include "tests/catch.hpp"

using namespace sweepd;

namespace {

std::shared_ptr<RobotStatus> robot(const std::string& name) {
  auto status = std::make_shared<RobotStatus>();
  RobotState state;
  state.name = name;
  status->state.publish(state);
  return status;
}

}  // namespace

TEST_CASE("the status line has each robot's stream, telegrams, last sweep and result",
          "[service_status]") {
  const auto arc = robot("arc");
  ServiceStatus service{ServiceStatus::Phase::serving, {arc, robot("other")}, {}, {}};
  CHECK(status_line(service) == "arc: no RSI now, 0 telegrams; other: no RSI now, 0 telegrams");

  RobotState state = *arc->state.newest();
  state.stream = StreamState{};
  state.link.telegrams = 1234;
  state.last_sweep = "joint 2: sweep of -70.0 deg in 3.57 s, 893 samples";
  arc->state.publish(state);
  ResultState result;
  result.newest = ResultState::Newest{identify::Status::partial, true, "", {}, {}, 0, nullptr};
  arc->result.publish(result);
  CHECK(status_line(service).starts_with(
      "arc: RSI streams, 1234 telegrams, last joint 2: sweep of -70.0 deg in 3.57 s, 893 samples, "
      "interim result partial; other"));

  state.recording_paused = true;
  arc->state.publish(state);
  service.robots.resize(1);
  service.standstills = {"arc: the reply thread has stood still for 5 s"};
  const auto line = status_line(service);
  CHECK(line.starts_with("STANDS STILL: arc: the reply thread has stood still for 5 s; arc: RSI"));
  CHECK(line.ends_with("recording PAUSES"));
}

TEST_CASE("the status line begins with the robots that are not served",
          "[service_status][issue11][point_7]") {
  ServiceStatus service{ServiceStatus::Phase::serving, {robot("arc")}, {}, {}};
  service.not_served = {{"far", "cannot listen"}};
  CHECK(status_line(service) == "NOT SERVED: far: cannot listen; arc: no RSI now, 0 telegrams");
}
