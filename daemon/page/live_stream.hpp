#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "daemon/service/live_slices.hpp"
#include "daemon/service/service_status.hpp"

namespace sweepd {

/// What one viewer of a robot is sent: server-sent events, schema "sweepd.live/1". It begins with
/// the last minute. Who asks more seldom than every two seconds misses slices, and is told how
/// many. One thread at a time.
class LiveStream {
 public:
  /// `robot` and its name as they are in `status`, which lives longer than this.
  LiveStream(const Published<ServiceStatus>& status, std::shared_ptr<const RobotStatus> robot);

  /// The events since the last call, empty where nothing happened. Nothing once the robot is not
  /// served any more.
  [[nodiscard]] std::optional<std::string> next();

  /// Slices that are kept for a viewer who is slow.
  static constexpr std::size_t kMostBehind = 20;

 private:
  void add_slices(std::string& text);

  const Published<ServiceStatus>& status_;
  const std::shared_ptr<const RobotStatus> robot_;
  const LiveSlices::Viewer viewer_{robot_->live};
  std::shared_ptr<const RobotFacts> facts_;
  std::shared_ptr<const RobotState> state_;
  std::shared_ptr<const ResultState> result_;
  std::uint64_t slice_ = 0;
  std::uint64_t sweep_ = 0;
};

}  // namespace sweepd
