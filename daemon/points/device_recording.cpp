#include "daemon/points/device_recording.hpp"

#include <chrono>
#include <utility>

namespace sweepd {

DeviceRecording::DeviceRecording(const RobotSetup& setup)
    : port_(setup.device.listen.endpoint.port) {
  if (port_ == 0) return;
  lines_.emplace(setup.device.columns);
  take_ = std::make_shared<DeviceTake>(DeviceTake{identify::AngleTape(setup.joints), {}, {}});
}

void DeviceRecording::device(const rsi::Datagram& datagram) {
  ++counts_.datagrams;
  if (!began_) began_ = datagram.time;
  std::string_view bytes = datagram.payload;
  while (!bytes.empty()) {
    Point point;
    point.sample.time_s = std::chrono::duration<double>(datagram.time - *began_).count();
    const auto line = lines_->read(next_line(bytes), point);
    if (line == DeviceLines::Line::point)
      keep(point);
    else if (line != DeviceLines::Line::empty && line != DeviceLines::Line::not_seen)
      ++counts_.others;
  }
}

void DeviceRecording::keep(const Point& point) {
  ++counts_.points;
  if (seen_.size() <= point.target) seen_.resize(point.target + 1);
  if (seen_[point.target]++ % stride_ != 0) return;
  auto& points = take_->points;
  points.push_back({point.target, point.sample});
  if (points.size() < kMostPoints) return;
  std::vector<std::size_t> kept(seen_.size());
  std::erase_if(points, [&](const auto& each) { return kept[each.target]++ % 2 != 0; });
  stride_ *= 2;
}

Snapshot DeviceRecording::with_device(Snapshot snapshot) {
  if (port_ == 0) return snapshot;
  take_->targets = lines_->targets();
  take_->step_mm = lines_->step_mm();
  snapshot.device = std::exchange(take_, nullptr);
  port_ = 0;
  return snapshot;
}

}  // namespace sweepd
