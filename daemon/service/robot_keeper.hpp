#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "daemon/service/service_status.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/system/heartbeat.hpp"
#include "daemon/system/log.hpp"

namespace sweepd {

class RobotService;
struct RobotThreads;

/// Why a robot is not served. A value, since threads tell each other of it.
struct Problem {
  std::string text;
  bool is_mistake = false;  ///< in the robot's files: trying again does not help
};

/// Sees to it that one robot of the settings is served: an address that this machine does not have
/// yet, a port that another program has, an output that cannot be made are tried again until they
/// are there. What may wait for a disk or a network has threads of its own here, for as long as it
/// takes: nobody else waits for it, but the destructor before finished().
class RobotKeeper {
 public:
  /// Reads the robot's files and takes its port, and waits for serve(). `on_change` is called by
  /// any thread when what is said of it here may have changed, and must not call it.
  RobotKeeper(RobotSettings settings, std::shared_ptr<RobotThreads> shared,
              std::function<void()> on_change);
  ~RobotKeeper();
  RobotKeeper(const RobotKeeper&) = delete;
  RobotKeeper& operator=(const RobotKeeper&) = delete;

  /// From now on the robot is answered, once it can be.
  void serve();
  /// As RobotService::reload(). A robot that is not served yet is tried at once.
  void reload(const RobotSettings& settings);
  void report_link();
  /// Ends in order what is under way: soon afterwards gone().
  void let_go();

  enum class Phase {
    trying,   ///< for the first time since the settings were read
    ready,    ///< only serve() is missing
    serving,  ///< the robot is answered
    waiting,  ///< it cannot be served now, and is tried again
    refused,  ///< its files hold a mistake: other settings are waited for
  };
  struct State {
    Phase phase = Phase::trying;
    bool settled = false;  ///< all that was asked for is done, or being tried again
    std::optional<Problem> problem;
    /// While it is served.
    std::optional<Heartbeat::Beats> beats;
    std::shared_ptr<const RobotStatus> status;
  };
  [[nodiscard]] State state() const;

  /// After let_go(): all is written, or given up.
  [[nodiscard]] bool gone() const;
  /// Of what is gone: nothing was given up.
  [[nodiscard]] bool complete() const;
  /// The threads have ended too.
  [[nodiscard]] bool finished() const;

 private:
  using Lock = std::unique_lock<std::mutex>;

  void start_keeping();
  void keep();
  /// Of a change: threads of this, and whoever asks it.
  void tell();
  void try_to_serve(Lock& lock);
  void failed(Lock& lock);
  void take_over(Lock& lock);
  void end(std::shared_ptr<RobotService> service);

  const Log log_;
  const std::shared_ptr<RobotThreads> shared_;
  const std::function<void()> on_change_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  RobotSettings wanted_;
  bool reread_ = false;  // wanted_ is new
  bool busy_ = false;    // with a reload
  bool may_serve_ = false;
  bool going_ = false;
  bool gone_ = false;
  bool complete_ = true;
  bool kept_ = false;  // by its thread
  int threads_ = 0;
  Phase phase_ = Phase::trying;
  std::optional<Problem> problem_;
  std::string said_;  // of the problem
  std::chrono::steady_clock::time_point failing_since_;
  std::chrono::milliseconds pause_{};
  std::shared_ptr<RobotService> service_;  // while it is served
  std::thread ending_;
  std::thread keeping_;
};

}  // namespace sweepd
