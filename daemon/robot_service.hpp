#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "daemon/job_thread.hpp"
#include "daemon/realtime.hpp"
#include "daemon/robot_setup.hpp"
#include "daemon/session.hpp"
#include "daemon/settings.hpp"
#include "rsi/server.hpp"

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

  /// Throws std::runtime_error where `realtime = "require"` cannot be had.
  void start();
  /// Takes over what can be changed: from the next session on, the limits of recording at once.
  /// Says what else has changed and needs a restart. Throws ConfigError, and changes nothing then.
  /// From the thread that calls start() and stop().
  void reload(const RobotSettings& settings);
  /// Ends the session under way with its last result and a complete recording; the controller is
  /// answered until that is done.
  void stop();

  [[nodiscard]] rsi::Endpoint local() const { return server_->local(); }

 private:
  using Steady = std::chrono::steady_clock;

  void serve(std::promise<RealTimeReport> ready);
  void say_real_time(const RealTimeReport& report);
  void acquire();
  void take_over();
  void drain();
  void take(const rsi::Datagram& datagram);
  void begin_session(const rsi::Datagram& first);
  void end_session();
  void on_sweep(const identify::Sweep& sweep);
  void identify(bool interim);
  [[nodiscard]] std::string run_file(const std::string& ended) const;

  RobotSettings settings_;
  RobotSetup setup_;
  std::unique_ptr<rsi::Server> server_;
  std::atomic<Steady::duration> identification_took_{};
  JobThread identification_;
  std::thread reply_thread_;
  std::thread acquisition_thread_;
  std::atomic<bool> stopping_{false};

  RobotSettings given_;       // by the last reload; of the thread that calls it
  std::string ethernet_xml_;  // what the Ethernet file held at the start
  struct Reloaded {
    RobotSettings settings;
    RobotSetup setup;
  };
  std::mutex reload_mutex_;
  std::optional<Reloaded> reloaded_;  // waits for the acquisition thread

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
