#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "daemon/settings/settings.hpp"
#include "daemon/system/log.hpp"
#include "rsi/server/text_receiver.hpp"

namespace sweepd {

/// Where a robot's measuring device sends its lines: a thread of its own receives them, with a
/// share of the processors that comes after replies, and into bounded memory. A robot is served
/// whether or not the port can be had: where it cannot, it is tried again.
class DevicePort {
 public:
  static constexpr std::chrono::milliseconds kBetweenTries{3000};

  /// Throws std::invalid_argument where the columns are wrong.
  explicit DevicePort(const DeviceSettings& settings,
                      std::chrono::milliseconds between_tries = kBetweenTries);
  ~DevicePort();
  DevicePort(const DevicePort&) = delete;
  DevicePort& operator=(const DevicePort&) = delete;

  void start();

  /// The next datagram that came, for one thread; its payload is valid until the next call.
  bool pop(rsi::Datagram& datagram);

  struct News {
    Importance importance{};
    std::string text;
  };
  /// Whether it listens, once; the thread that calls pop().
  [[nodiscard]] std::optional<News> news();
  /// What was dropped, and what to do; at most once a minute. The same thread.
  [[nodiscard]] std::optional<std::string> complaint(std::chrono::steady_clock::time_point now);
  /// The end: also what waits for its minute.
  [[nodiscard]] std::optional<std::string> rest() {
    again_ = {};
    return complaint({});
  }

 private:
  void listen();

  const TextPort port_;
  const std::chrono::milliseconds between_tries_;
  std::mutex mutex_;
  std::condition_variable stopping_changed_;
  bool stopping_ = false;
  std::string problem_;                              // why there is no receiver
  std::unique_ptr<rsi::TextReceiver> receiver_;      // is set once
  std::atomic<rsi::TextReceiver*> ready_ = nullptr;  // the same, for the thread that calls pop()
  std::thread thread_;
  bool said_ready_ = false;
  std::string said_problem_;
  std::uint64_t dropped_ = 0, too_long_ = 0;  // that were said
  std::chrono::steady_clock::time_point again_{};
};

}  // namespace sweepd
