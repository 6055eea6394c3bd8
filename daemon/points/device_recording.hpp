#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/points/device_lines.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/stream/device_take.hpp"
#include "daemon/stream/session.hpp"
#include "rsi/datagram.hpp"

namespace sweepd {

/// Gathers what a robot's device sends while a session goes on, and the angles that the controller
/// tells meanwhile. Live and replayed datagrams take the same way. Without a device in the settings
/// it takes nothing, and costs nothing. One thread. Bounded memory.
class DeviceRecording {
 public:
  /// Of half an hour at 300 Hz; where there are more, every second one goes.
  static constexpr std::size_t kMostPoints = 500'000;

  /// Throws std::invalid_argument where the columns of the device are wrong.
  explicit DeviceRecording(const RobotSetup& setup);

  /// Whether a datagram came to the device's port.
  [[nodiscard]] bool is_device(const rsi::Datagram& datagram) const {
    return port_ != 0 && datagram.destination.port == port_;
  }
  void device(const rsi::Datagram& datagram);
  /// A telegram of the controller came: the first one is time zero of lines without a time.
  void telegram(const rsi::Datagram& datagram) {
    if (port_ != 0 && !began_) began_ = datagram.time;
  }
  void sample(const identify::Sample& sample) {
    if (port_ != 0) take_->angles.add(sample);
  }

  struct Counts {
    std::uint64_t datagrams = 0;
    std::uint64_t points = 0;
    std::uint64_t others = 0;  ///< lines that are neither points nor empty
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// The session's, with what the device saw beside it, which may be nothing. Call it once, at the
  /// end.
  [[nodiscard]] Snapshot with_device(Snapshot snapshot);

 private:
  void keep(const Point& point);

  std::uint16_t port_;
  std::optional<DeviceLines> lines_;
  std::optional<rsi::Timestamp> began_;
  std::shared_ptr<DeviceTake> take_;
  std::size_t stride_ = 1;         // of each target's points, every n-th is kept
  std::vector<std::size_t> seen_;  // points of each target
  Counts counts_;
};

}  // namespace sweepd
