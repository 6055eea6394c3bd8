#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "daemon/settings/settings.hpp"
#include "rsi/server/text_receiver.hpp"

namespace sweepd {

/// Where a robot's measuring device sends its lines: a thread of its own receives them, with a
/// share of the processors that comes after replies, and into bounded memory.
class DevicePort {
 public:
  /// Listens. Throws std::runtime_error with what to do.
  explicit DevicePort(const DeviceSettings& settings);
  ~DevicePort();
  DevicePort(const DevicePort&) = delete;
  DevicePort& operator=(const DevicePort&) = delete;

  void start();

  /// The next datagram that came, for one thread; its payload is valid until the next call.
  bool pop(rsi::Datagram& datagram) { return receiver_.datagrams().pop(datagram); }
  /// What was dropped, and what to do; at most once a minute. The thread that calls pop().
  [[nodiscard]] std::optional<std::string> complaint(std::chrono::steady_clock::time_point now);
  /// The end: also what waits for its minute.
  [[nodiscard]] std::optional<std::string> rest() {
    again_ = {};
    return complaint({});
  }

 private:
  rsi::TextReceiver receiver_;
  std::thread thread_;
  std::uint64_t dropped_ = 0, too_long_ = 0;  // that were said
  std::chrono::steady_clock::time_point again_{};
};

}  // namespace sweepd
