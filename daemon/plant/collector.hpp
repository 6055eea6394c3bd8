#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "daemon/plant/broker_link.hpp"
#include "daemon/plant/campaign_store.hpp"
#include "daemon/plant/database.hpp"
#include "daemon/system/log.hpp"

namespace sweepd {

/// Writes the broker's messages into the database. take() returns once a message is stored, however
/// long the database is away: Paho acknowledges it to the broker after that, and not at all if the
/// program ends before. So the broker sends again whatever is not in the database.
class Collector {
 public:
  using Steady = std::chrono::steady_clock;

  explicit Collector(std::string connection) : database_(std::move(connection)) {}

  /// Paho's thread. Never throws.
  void take(const BrokerLink::Message& message);
  /// From now on nothing is tried again. Any thread.
  void stop() { stopping_ = true; }
  /// Whether take() is at work.
  [[nodiscard]] bool busy() const { return busy_; }
  /// What take() has put aside of states. Once no message comes any more.
  void finish();

  [[nodiscard]] std::uint64_t stored() const { return stored_; }

 private:
  /// Until the database has it; false if the program ends before.
  template <typename Work>
  bool until_done(const Work& work);
  void store(const BrokerLink::Message& message);
  using Links = std::map<std::string, std::pair<RobotPlace, ToldLink>>;
  void add_links();
  /// Of one robot; says so where they are refused.
  void add_link(const Links::value_type& link);
  CampaignStore& open();

  std::mutex one_;  ///< take() or finish()
  Log log_;
  Database database_;
  std::optional<CampaignStore> store_;
  Links links_;  ///< the newest, by topic
  Steady::time_point links_due_{};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> busy_{false};
  std::atomic<std::uint64_t> stored_{0};
};

}  // namespace sweepd
