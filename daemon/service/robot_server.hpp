#pragma once

#include <future>
#include <memory>
#include <optional>
#include <thread>

#include "daemon/settings/settings.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/server/server.hpp"
#include "rsi/telegram/ethernet_config.hpp"

namespace sweepd {

/// The robot's Ethernet file; nothing where the settings name none. Throws
/// rsi::EthernetConfigError, or ConfigError where it must not be answered (see answers.hpp).
[[nodiscard]] std::optional<rsi::EthernetConfig> ethernet_config_of(const RobotSettings& settings);

/// The server for a robot: over UDP or TCP, with the replies that its controller's Ethernet file
/// asks for; where `tap` is set, what listens to another program's. What is doubtful is logged.
/// Throws as ethernet_config_of does, or std::runtime_error.
[[nodiscard]] std::unique_ptr<rsi::Server> make_server(const RobotSettings& settings);

/// The thread that answers a robot's controller, and nothing else.
class ReplyThread {
 public:
  /// `server` outlives this, or stop().
  explicit ReplyThread(rsi::Server& server) : server_(server) {}
  ~ReplyThread() { stop(); }
  ReplyThread(const ReplyThread&) = delete;
  ReplyThread& operator=(const ReplyThread&) = delete;

  /// Tells what was granted of real time, as soon as the thread answers.
  RealTimeReport start(const RealTimeSettings& wish);
  void stop();
  [[nodiscard]] bool runs() const { return thread_.joinable(); }

 private:
  void serve(const RealTimeSettings& wish, std::promise<RealTimeReport> ready);

  rsi::Server& server_;
  std::thread thread_;
};

}  // namespace sweepd
