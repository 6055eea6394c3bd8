#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>

#include "daemon/job_thread.hpp"
#include "daemon/robot_setup.hpp"
#include "daemon/session.hpp"
#include "daemon/settings.hpp"
#include "rsi/udp_server.hpp"

namespace sweepd {

/// Serves one controller: the reply thread answers, the acquisition thread does all the rest but
/// the identification, which has a thread of its own.
class RobotService {
 public:
  /// Reads the robot's files, makes its output folder, binds the socket. Throws ConfigError or
  /// std::runtime_error.
  explicit RobotService(const RobotSettings& settings);
  ~RobotService();  ///< as stop()
  RobotService(const RobotService&) = delete;
  RobotService& operator=(const RobotService&) = delete;

  void start();
  /// Ends the session under way with its last result and a complete recording; the controller is
  /// answered until that is done.
  void stop();

  [[nodiscard]] rsi::Endpoint local() const { return server_.local(); }

 private:
  using Steady = std::chrono::steady_clock;

  void acquire();
  void drain();
  void take(const rsi::Datagram& datagram);
  void begin_session(const rsi::Datagram& first);
  void end_session();
  void on_sweep(const identify::Sweep& sweep);
  void identify(bool interim);
  [[nodiscard]] std::string run_file(const std::string& ended) const;

  RobotSettings settings_;
  RobotSetup setup_;
  rsi::UdpServer server_;
  std::atomic<Steady::duration> identification_took_{};
  JobThread identification_;
  std::thread reply_thread_;
  std::thread acquisition_thread_;
  std::atomic<bool> stopping_{false};

  // The acquisition thread's own.
  std::optional<Session> session_;
  std::filesystem::path folder_;  // of the session; empty if it could not be made
  std::string started_;
  std::uint32_t local_address_ = 0;  // as the controller sees it
  std::uint64_t overflows_said_ = 0;
  Steady::time_point last_datagram_;
  Steady::time_point last_identification_;
  Steady::time_point last_flush_;
};

}  // namespace sweepd
