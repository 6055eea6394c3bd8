#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include <mqtt/async_client.h>

#include "daemon/settings/plant_settings.hpp"
#include "daemon/system/log.hpp"

namespace sweepd {

/// Makes the folder of what is on its way where there is none. Throws std::runtime_error.
void make_spool(const std::filesystem::path& spool);

/// One MQTT 5 connection, which comes back whenever it is lost. Who owns it calls keep() often,
/// from one thread; the broker's messages come on a thread of Paho's.
class BrokerLink {
 public:
  using Steady = std::chrono::steady_clock;
  using Names = std::map<std::string, std::string>;  ///< MQTT's user properties
  /// Also told whether the broker had kept the message for whoever subscribes.
  struct Message {
    std::string topic;
    std::string_view payload;  ///< while the call lasts
    Names names;
  };
  struct Options {
    BrokerSettings broker;
    std::string client;           ///< its name at the broker, unique there
    std::filesystem::path spool;  ///< where Paho keeps what is on its way
    std::string will_topic;       ///< retained there when the connection breaks; empty: no will
    std::string will;
    std::map<std::string, int> topics;  ///< to subscribe to, with the quality of service
    /// The message is acknowledged once this returns. It must not throw.
    std::function<void(const Message&)> take;
  };

  /// Throws ConfigError for credentials and std::runtime_error for a spool that cannot be used.
  BrokerLink(Options options, Log log);
  ~BrokerLink();
  BrokerLink(const BrokerLink&) = delete;
  BrokerLink& operator=(const BrokerLink&) = delete;

  /// Connects where it is not connected and it is time to. Says what changed.
  void keep(Steady::time_point now);
  [[nodiscard]] bool connected() const { return connected_; }

  /// A message that was handed over.
  class Delivery {
   public:
    enum class Is { under_way, done, failed };
    explicit Delivery(mqtt::delivery_token_ptr token) : token_(std::move(token)) {}
    [[nodiscard]] Is now() const;
    [[nodiscard]] const std::string& why() const { return why_; }  ///< it failed

   private:
    mqtt::delivery_token_ptr token_;
    mutable std::string why_;
  };
  /// Once connected. Throws std::runtime_error with what to do where Paho refuses it.
  [[nodiscard]] Delivery publish(const std::string& topic, std::string_view payload, int quality,
                                 bool retained, const Names& names = {});
  /// In order: no will is told. Waits for a second at most.
  void leave() noexcept;

 private:
  void begin(Steady::time_point now);
  /// Asks for those that are still to come, and says which are refused.
  void look_after_subscriptions(Steady::time_point now);
  void lost(Steady::time_point now);
  void failed(const std::string& why, Steady::time_point now);

  Options options_;
  Log log_;
  mqtt::connect_options connect_;
  mqtt::async_client client_;
  mqtt::token_ptr trying_;
  std::map<std::string, mqtt::token_ptr> subscriptions_;  ///< not granted yet
  Steady::time_point subscribe_at_{};
  Steady::time_point again_at_{};
  std::chrono::seconds pause_{1};
  Steady::time_point connected_at_{};
  int short_ones_ = 0;  ///< connections in a row that ended as soon as they began
  bool connected_ = false;
  std::string said_;                     ///< why the broker is out of reach
  std::atomic<bool> taken_over_{false};  ///< the broker said so
};

}  // namespace sweepd
