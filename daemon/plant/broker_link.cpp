#include "daemon/plant/broker_link.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "daemon/settings/toml_table.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/system/disk_room.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongestPause = 30s;
constexpr auto kKeepAlive = 30s;
constexpr auto kConnectTimeout = 10s;
constexpr auto kShort = 10s;
constexpr int kMostShortOnes = 3;
constexpr auto kTruce = 10min;

std::string uri_of(const BrokerAddress& broker) {
  return (broker.tls ? "ssl://" : "tcp://") + broker.host + ':' + std::to_string(broker.port);
}

/// A credential that systemd gave the service (LoadCredential=), as a file.
std::optional<std::filesystem::path> credential(const std::string& name) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nobody sets it
  const char* const folder = std::getenv("CREDENTIALS_DIRECTORY");
  if (folder == nullptr) return std::nullopt;
  auto file = std::filesystem::path(folder) / name;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  return file;
}

/// What is in a file without line ends behind it. Throws ConfigError.
std::string read_secret(const std::filesystem::path& file) {
  auto text = rsi::readable_bytes(file);
  if (!text)
    throw ConfigError(file.string() +
                      ": cannot be read: check the path and who may read it, or hand it over with "
                      "LoadCredential= of the unit");
  while (!text->empty() && (text->back() == '\n' || text->back() == '\r')) text->pop_back();
  if (text->empty()) throw ConfigError(file.string() + ": is empty: write the password into it");
  return std::move(*text);
}

/// Paho would only say that there is no connection. Throws ConfigError.
void check_readable(const std::optional<std::filesystem::path>& file, const char* key) {
  if (file && !rsi::readable_bytes(*file))
    throw ConfigError(file->string() + ": cannot be read: check `" + key +
                      "`, and whether the service's user may read the file");
}

mqtt::ssl_options tls_of(const BrokerSettings& broker) {
  check_readable(broker.ca_file, "ca_file");
  check_readable(broker.certificate_file, "certificate_file");
  check_readable(broker.key_file, "key_file");
  mqtt::ssl_options tls;
  if (broker.ca_file)
    tls.set_trust_store(broker.ca_file->string());
  else
    tls.ca_path("/etc/ssl/certs");
  if (broker.certificate_file) {
    tls.set_key_store(broker.certificate_file->string());
    if (const auto key = broker.key_file ? broker.key_file : credential("mqtt-key"))
      tls.set_private_key(key->string());
  }
  tls.set_enable_server_cert_auth(true);
  tls.set_verify(true);  // the host's name is that of the certificate
  tls.set_ssl_version(MQTT_SSL_VERSION_TLS_1_2);
  return tls;
}

mqtt::connect_options connect_of(const BrokerLink::Options& options) {
  mqtt::connect_options connect;
  connect.set_mqtt_version(MQTTVERSION_5);
  // The broker keeps the session: what it has for us waits, and what we sent is not sent twice.
  connect.set_clean_start(false);
  connect.set_properties({{mqtt::property::SESSION_EXPIRY_INTERVAL,
                           static_cast<std::int32_t>(options.topics.empty() ? 86'400 : -1)}});
  connect.set_keep_alive_interval(kKeepAlive);
  connect.set_connect_timeout(kConnectTimeout);
  if (options.broker.user) connect.set_user_name(*options.broker.user);
  const auto password =
      options.broker.password_file ? options.broker.password_file : credential("mqtt-password");
  if (password) connect.set_password(read_secret(*password));
  if (options.broker.address.tls) connect.set_ssl(tls_of(options.broker));
  if (!options.will_topic.empty())
    connect.set_will(mqtt::will_options(options.will_topic, options.will, 1, true));
  return connect;
}

/// What Paho says of a failure, without its numbers.
std::string reason_of(const mqtt::exception& problem) {
  for (const int code : {problem.get_reason_code(), problem.get_return_code()})
    if (code > mqtt::ReasonCode::GRANTED_QOS_2) return mqtt::exception::reason_code_str(code);
  const std::string message = problem.get_message().empty()
                                  ? mqtt::exception::error_str(problem.get_return_code())
                                  : problem.get_message();
  return message.empty() ? "no connection" : message;
}

/// What has to be right for a connection, if more than that the broker runs.
const char* advice(const std::string& why, bool tls) {
  const auto says = [&](const char* words) { return why.find(words) != why.npos; };
  if (says("uthorized") || says("password"))
    return "; `user` and the password have to be those that the broker knows";
  if (why == "Failure") return "; `broker` may name another machine";
  if (!tls && says("completion")) return "; where it wants TLS, `broker` begins with mqtts://";
  return tls ? "; its certificate has to be one of `ca_file`, and of this name" : "";
}

/// Why a finished token failed; empty where it did not.
std::string failure_of(mqtt::token& token) {
  try {
    token.try_wait();
    return {};
  } catch (const mqtt::exception& problem) {
    return reason_of(problem);
  }
}

/// Paho writes a message twice before it is on its way, the second time on a thread of its own, and
/// crashes there when the disk is full. There may be four results under way.
bool has_room(const std::filesystem::path& spool, std::size_t bytes) {
  constexpr std::uint64_t kForOthers = 1 << 20;
  const auto room = disk_room(spool);
  return !room || room->free >= kForOthers + 8 * std::uint64_t{bytes};
}

std::string made(const std::filesystem::path& spool) {
  make_spool(spool);
  return spool.string();
}

BrokerLink::Names names_of(const mqtt::properties& properties) {
  BrokerLink::Names names;
  const std::size_t count = properties.count(mqtt::property::USER_PROPERTY);
  for (std::size_t i = 0; i < count; ++i) {
    auto [name, value] = mqtt::get<mqtt::string_pair>(properties, mqtt::property::USER_PROPERTY, i);
    names.emplace(std::move(name), std::move(value));
  }
  return names;
}

}  // namespace

void make_spool(const std::filesystem::path& spool) {
  make_folder(spool, "give another `spool`, or make this one writable");
}

BrokerLink::BrokerLink(Options options, Log log)
    : options_(std::move(options)),
      log_(std::move(log)),
      connect_(connect_of(options_)),
      client_(uri_of(options_.broker.address), options_.client,
              mqtt::create_options(MQTTVERSION_5, 1000), made(options_.spool)) {
  client_.set_disconnected_handler([this](const mqtt::properties&, mqtt::ReasonCode reason) {
    if (reason == mqtt::ReasonCode::SESSION_TAKEN_OVER) taken_over_ = true;
  });
  if (options_.take)
    client_.set_message_callback([this](const mqtt::const_message_ptr& message) {
      options_.take(
          {message->get_topic(), message->get_payload_str(), names_of(message->get_properties())});
    });
}

BrokerLink::~BrokerLink() {
  leave();
}

void BrokerLink::keep(Steady::time_point now) {
  if (connected_) {
    if (client_.is_connected()) return look_after_subscriptions(now);
    lost(now);
  }
  if (!trying_) {
    if (now >= again_at_) begin(now);
    return;
  }
  if (!trying_->is_complete()) return;
  const std::string why = failure_of(*trying_);
  trying_.reset();
  if (!why.empty()) return failed(why, now);
  connected_ = true;
  connected_at_ = now;
  said_.clear();
  pause_ = 1s;
  log_.note("connected to the broker {}", text(options_.broker.address));
  subscriptions_.clear();
  for (const auto& [topic, quality] : options_.topics) subscriptions_[topic];
  subscribe_at_ = now;
  look_after_subscriptions(now);
}

void BrokerLink::look_after_subscriptions(Steady::time_point now) {
  for (auto one = subscriptions_.begin(); one != subscriptions_.end();) {
    auto& [topic, asked] = *one;
    std::string why;
    if (asked && asked->is_complete()) {
      why = failure_of(*asked);
      asked.reset();
      if (why.empty()) {
        one = subscriptions_.erase(one);
        continue;
      }
    } else if (!asked && now >= subscribe_at_) {
      try {
        asked = client_.subscribe(topic, options_.topics.at(topic));
      } catch (const mqtt::exception& problem) {
        why = reason_of(problem);
      }
    }
    if (!why.empty()) {
      log_.error(
          "the broker {} refuses the subscription to {} ({}): nothing of it comes; its access list "
          "has to let `user` read that. It is tried again every {} s",
          text(options_.broker.address), topic, why, kLongestPause.count());
      subscribe_at_ = now + kLongestPause;
    }
    ++one;
  }
}

void BrokerLink::lost(Steady::time_point now) {
  connected_ = false;
  again_at_ = now;
  short_ones_ = now - connected_at_ < kShort ? short_ones_ + 1 : 0;
  if (!taken_over_.exchange(false) && short_ones_ < kMostShortOnes) {
    log_.warning("the connection to the broker {} is lost", text(options_.broker.address));
    return;
  }
  // Two of one name take the connection from each other for ever: this one lets the other have it.
  // A broker may also close it for a topic that its access list forbids.
  log_.error(
      "the broker {} closes the connection of {} as soon as it is open: another client has the "
      "same name, as two publishers for one robot have, or two collectors; or its access list does "
      "not let `user` write under `site` and `cell`, which the broker's log tells. End one of the "
      "two, give a second collector another `client`, or correct the list. This one tries again in "
      "10 minutes",
      text(options_.broker.address), options_.client);
  again_at_ = now + kTruce;
  short_ones_ = 0;
}

void BrokerLink::begin(Steady::time_point now) {
  try {
    trying_ = client_.connect(connect_);
  } catch (const mqtt::exception& problem) {
    failed(reason_of(problem), now);
  }
}

void BrokerLink::failed(const std::string& why, Steady::time_point now) {
  again_at_ = now + pause_;
  pause_ = std::min<std::chrono::seconds>(2 * pause_, kLongestPause);
  // Away first, and then with another password: the second is what somebody has to know.
  if (said_ != why)
    log_.warning("the broker {} cannot be reached ({}): it is tried again until it answers{}",
                 text(options_.broker.address), why, advice(why, options_.broker.address.tls));
  said_ = why;
}

BrokerLink::Delivery BrokerLink::publish(const std::string& topic, std::string_view payload,
                                         int quality, bool retained, const Names& names) {
  const auto full = [&] {
    return std::runtime_error("cannot write into the spool " + options_.spool.string() +
                              ": make room on its disk, or give another spool");
  };
  if (!has_room(options_.spool, payload.size())) throw full();
  mqtt::properties properties;
  for (const auto& [name, value] : names)
    properties.add({mqtt::property::USER_PROPERTY, name, value});
  try {
    return Delivery(client_.publish(mqtt::message_ptr_builder()
                                        .topic(topic)
                                        .payload(payload.data(), payload.size())
                                        .qos(quality)
                                        .retained(retained)
                                        .properties(std::move(properties))
                                        .finalize()));
  } catch (const mqtt::exception& problem) {
    if (problem.get_return_code() == MQTTASYNC_PERSISTENCE_ERROR) throw full();
    throw std::runtime_error("cannot publish " + topic + ": " + reason_of(problem));
  }
}

BrokerLink::Delivery::Is BrokerLink::Delivery::now() const {
  if (!token_->is_complete()) return Is::under_way;
  why_ = failure_of(*token_);
  return why_.empty() ? Is::done : Is::failed;
}

void BrokerLink::leave() noexcept {
  try {
    if (client_.is_connected()) client_.disconnect(1000)->wait_for(1s);
  } catch (const std::exception&) {  // it is gone then
  }
  connected_ = false;
}

}  // namespace sweepd
