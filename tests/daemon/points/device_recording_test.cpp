#include "daemon/points/device_recording.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "daemon/results/outcome.hpp"
#include "tests/catch.hpp"

using namespace sweepd;
using namespace std::chrono_literals;
using Catch::Matchers::WithinAbs;

namespace {

constexpr rsi::Endpoint kDevicePort{0x7f000001, 5005};

RobotSetup with_device(const std::string& columns) {
  RobotSetup setup;
  setup.device.listen.endpoint = kDevicePort;
  setup.device.columns.text = columns;
  return setup;
}

rsi::Datagram datagram(rsi::Timestamp time, std::string_view payload,
                       const rsi::Endpoint& to = kDevicePort) {
  return {time, {0x7f000002, 4000}, to, payload, false};
}

identify::Sample told(double time_s) {
  identify::Sample sample;
  sample.time_s = time_s;
  sample.joints = 6;
  return sample;
}

}  // namespace

TEST_CASE("Lines and angles of a session are gathered side by side", "[device_recording]") {
  DeviceRecording recording(with_device("x_mm,y_mm,z_mm"));
  const rsi::Timestamp begin = 1000s;
  CHECK(recording.is_device(datagram(begin, "")));
  CHECK_FALSE(recording.is_device(datagram(begin, "", {0x7f000001, 49152})));
  recording.telegram(datagram(begin, "", {0x7f000001, 49152}));
  for (int i = 0; i < 10; ++i) recording.sample(told(0.004 * i));
  recording.device(datagram(begin + 250ms, "1.25,2,3\n4,5,6\ngarbage\n# comment\n"));
  CHECK(recording.counts().points == 2);
  CHECK(recording.counts().others == 1);

  const auto snapshot = recording.with_device({});
  REQUIRE(snapshot.device);
  CHECK(snapshot.device->angles.size() == 10);
  REQUIRE(snapshot.device->points.size() == 2);
  CHECK_THAT(snapshot.device->points[1].sample.time_s, WithinAbs(0.25, 1e-12));
  CHECK(snapshot.device->points[1].sample.position_mm == Eigen::Vector3d(4, 5, 6));
  CHECK_THAT(snapshot.device->step_mm, WithinAbs(0.01, 1e-12));
  CHECK_FALSE(snapshot.device->required);
}

TEST_CASE("A session of hours keeps a bounded number of points, of all targets and all of its time",
          "[device_recording]") {
  DeviceRecording recording(with_device("target,x_mm,y_mm,z_mm"));
  constexpr int kPictures = 600'000;
  for (int i = 0; i < kPictures; ++i)
    recording.device(datagram(1000s + 10ms * i, "A,1,2,3\nB,4,5,6\n"));
  const auto snapshot = recording.with_device({});
  const auto& points = snapshot.device->points;
  CHECK(points.size() <= DeviceRecording::kMostPoints);
  CHECK(points.size() > DeviceRecording::kMostPoints / 4);
  const auto of_a = std::count_if(points.begin(), points.end(),
                                  [](const auto& point) { return point.target == 0; });
  CHECK(std::abs(2 * of_a - static_cast<std::ptrdiff_t>(points.size())) < 4);
  CHECK(points.back().sample.time_s > 0.99 * 0.01 * kPictures);
}

TEST_CASE("Without a device there is nothing beside the session, and of a silent one that is told",
          "[device_recording]") {
  DeviceRecording none{RobotSetup{}};
  none.sample(told(0));
  CHECK_FALSE(none.is_device(datagram(1s, "", {})));
  CHECK_FALSE(none.with_device({}).device);
  DeviceRecording silent(with_device("x_mm,y_mm,z_mm"));
  silent.sample(told(0));
  const auto snapshot = silent.with_device({});
  REQUIRE(snapshot.device);
  const auto warnings = outcome_of(snapshot).identification.warnings;
  CHECK(std::any_of(warnings.begin(), warnings.end(), [](const auto& one) {
    return one.code == "device_left_out" &&
           one.message.starts_with("the device's points are left out: none came.");
  }));
}
