#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/plant/broker_link.hpp"
#include "daemon/plant/daemon_state.hpp"
#include "daemon/plant/outbox.hpp"
#include "daemon/plant/topics.hpp"

namespace sweepd {

/// One robot's connection to the broker, since MQTT has one last will a connection. One thread.
class RobotPublisher {
 public:
  using Steady = std::chrono::steady_clock;
  struct Options {
    RobotPlace place;
    BrokerSettings broker;
    std::filesystem::path spool;    ///< of all robots of this publisher
    std::filesystem::path results;  ///< the robot's folder
    bool again = false;             ///< also what was published
  };

  explicit RobotPublisher(const Options& options);

  /// Often: `look` where something may have come into the folders.
  void turn(Steady::time_point now, bool look);
  /// What sweepd tells of this robot now; null and why, where it tells nothing.
  void hear(const nlohmann::ordered_json& state, const std::string& trouble,
            Steady::time_point now);
  /// In order: says that the publisher ends.
  void leave();

  [[nodiscard]] bool connected() const { return link_.connected(); }
  /// A result is on its way.
  [[nodiscard]] bool busy() const { return !under_way_.empty(); }
  [[nodiscard]] const std::vector<std::filesystem::path>& watched() const {
    return outbox_.unfinished();
  }
  [[nodiscard]] const std::filesystem::path& results() const { return results_; }

 private:
  /// A result on its way, with all that is told of it.
  struct UnderWay {
    std::string session;
    std::string sha256;
    std::vector<BrokerLink::Delivery> parts;
    Steady::time_point since;
  };

  void publish(const FinishedResult& result, Steady::time_point now);
  void look_after_deliveries(Steady::time_point now);
  void tell_online();
  void tell_sweeps(const nlohmann::ordered_json& state);
  void say(const std::string& kind, const std::string& payload, int quality, bool retained);

  RobotPlace place_;
  std::filesystem::path results_;
  Log log_;
  Ledger ledger_;
  Outbox outbox_;
  BrokerLink link_;
  std::vector<UnderWay> under_way_;
  nlohmann::ordered_json state_;
  std::string trouble_ = "sweepd was not asked yet";
  Steady::time_point state_due_{};
  Steady::time_point results_due_{};
  bool look_ = true;
  bool was_connected_ = false;
};

}  // namespace sweepd
