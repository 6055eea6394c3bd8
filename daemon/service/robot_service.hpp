#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "daemon/points/device_recording.hpp"
#include "daemon/record/recorder.hpp"
#include "daemon/results/run_json.hpp"
#include "daemon/service/device_port.hpp"
#include "daemon/service/identifier.hpp"
#include "daemon/service/interim_pace.hpp"
#include "daemon/service/link_watch.hpp"
#include "daemon/service/live_feed.hpp"
#include "daemon/service/robot_inputs.hpp"
#include "daemon/service/robot_server.hpp"
#include "daemon/service/robot_tally.hpp"
#include "daemon/service/robot_threads.hpp"
#include "daemon/service/service_status.hpp"
#include "daemon/service/waiting_datagrams.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/stream/session.hpp"
#include "daemon/system/heartbeat.hpp"
#include "daemon/system/log.hpp"
#include "rsi/server/server.hpp"

namespace sweepd {

/// Serves one controller: a reply thread of its own answers, acquisition does all the rest but the
/// identification and the work on files. Acquisition and recording are on threads that robots
/// share.
class RobotService : private StreamSink {
 public:
  /// Reads the robot's files, makes its output folder, binds the socket. Throws ConfigError or
  /// std::runtime_error.
  explicit RobotService(const RobotSettings& settings,
                        std::shared_ptr<RobotThreads> threads = std::make_shared<RobotThreads>());
  ~RobotService() override;  ///< as stop()
  RobotService(const RobotService&) = delete;
  RobotService& operator=(const RobotService&) = delete;

  /// Throws std::runtime_error where `realtime = "require"` cannot be had.
  void start();
  /// Takes over what can be changed: from the next session on, the limits of recording at once.
  /// Says what else has changed and needs a restart. Throws ConfigError or std::runtime_error, and
  /// changes nothing then. One thread at a time; stop() may come meanwhile.
  void reload(const RobotSettings& settings);
  /// Writes how the link does into the session's folder, and says it. Any thread; soon afterwards.
  void report_link() noexcept { link_wanted_ = true; }
  /// Ends the session under way with its last result and a complete recording; the controller is
  /// answered until that is done. A disk that does not answer is waited for no longer than for
  /// `patience`: then this returns false, what was lost is said, and the destructor would wait.
  bool stop(std::chrono::seconds patience = std::chrono::seconds(10));

  /// Whether its threads move. Any thread.
  [[nodiscard]] Heartbeat::Beats beats() const {
    return {log_.subject().robot, server_->beats(), acquisition_beats_};
  }

  /// How it is: published about once a second. Any thread, also after the end of this.
  [[nodiscard]] std::shared_ptr<const RobotStatus> status() const { return status_; }

  [[nodiscard]] rsi::Endpoint local() const { return local_; }

 private:
  using Steady = std::chrono::steady_clock;

  void say_real_time(const RealTimeReport& report);
  /// Of acquisition; returns when the next one is due.
  Steady::time_point turn();
  void take_over();
  /// False if there is more.
  bool drain();
  void take(const rsi::Datagram& datagram, rsi::Handling handling);
  /// The session is not about this one: it waits, unless it streams.
  void take_from_other(const rsi::Datagram& datagram, rsi::Handling handling, std::uint32_t peer);
  void take_waiting();
  void take_device();
  void begin_session(const rsi::Datagram& first);
  void end_session();
  void sample(const identify::Sample& sample, std::string_view row) override {
    recorder_.line(row);
    device_->sample(sample);
    live_.sample(sample);
  }
  void sweep(const identify::Sweep& sweep) override;
  void say_link();
  void complain();
  void publish();
  void show();  ///< to those who look at the live page
  [[nodiscard]] RunFacts run_facts() const;

  RobotInputs inputs_;
  std::unique_ptr<rsi::Server> server_;  // null after the end: another one may have the port
  const rsi::Endpoint local_;
  std::unique_ptr<DevicePort> device_port_;  // null without a device
  const Log log_;
  const std::shared_ptr<RobotStatus> status_;
  const std::shared_ptr<RobotThreads> threads_;
  Recorder recorder_;
  Identifier identifier_;
  ReplyThread reply_thread_;
  std::atomic<bool> link_wanted_{false};
  std::atomic<std::uint64_t> acquisition_beats_{0};

  ReloadedInputs reloaded_;

  // Acquisition's own.
  Log session_log_;
  std::optional<Session> session_;
  std::optional<DeviceRecording> device_;       // of the session
  PlannedTurns turns_;                          // of the session
  LinkWatch watch_;                             // of the session
  std::shared_ptr<const Recording> recording_;  // of the session
  std::optional<TurnThreads::Group> disk_;      // of the next session, if it may be another one
  std::string started_;
  std::uint32_t controller_ = 0;  // address
  WaitingDatagrams waiting_;
  LinkComplaints complaints_;
  rsi::Server::Counts before_;  // this session
  RobotTally tally_;
  LiveFeed live_;
  bool facts_told_ = true;
  const Steady::time_point began_ = Steady::now();
  Steady::time_point published_;
  Steady::time_point last_datagram_;
  InterimPace interim_pace_;

  std::unique_ptr<TurnThreads::Work> acquisition_;  // its turns use all of the above
};

}  // namespace sweepd
