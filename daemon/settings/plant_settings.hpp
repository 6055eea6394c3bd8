#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepd {

class TomlTable;
struct OptionText;

/// "mqtt://HOST:PORT", or mqtts://, which is TLS.
struct BrokerAddress {
  bool tls = false;
  std::string host;
  std::uint16_t port = 0;
  bool operator==(const BrokerAddress&) const = default;
};
/// Nothing where it is none. Without a port it is 1883, or 8883 of mqtts://.
[[nodiscard]] std::optional<BrokerAddress> parse_broker(std::string_view text);
[[nodiscard]] std::string text(const BrokerAddress& broker);

/// Any words, but some.
struct Words {
  std::string text;
  bool operator==(const Words&) const = default;
};

/// How a broker is reached, of [publish] and [collect].
struct BrokerSettings {
  BrokerAddress address;
  std::optional<std::string> user;
  std::optional<std::filesystem::path> password_file;
  std::optional<std::filesystem::path> ca_file;           ///< absent: the system's
  std::optional<std::filesystem::path> certificate_file;  ///< of this client
  std::optional<std::filesystem::path> key_file;
};

/// [publish] of sweepd.toml.
struct PublishSettings {
  BrokerSettings broker;
  Words site;
  Words cell;
  std::filesystem::path spool = "/var/lib/sweepd-publish";
};

/// [collect] of collect.toml, on the plant's server.
struct CollectSettings {
  BrokerSettings broker;
  Words database;                  ///< libpq's connection string
  Words client{"sweepd-collect"};  ///< the name at the broker, which keeps messages by it
  std::filesystem::path spool = "/var/lib/sweepd-collect";
};

/// Both throw ConfigError.
[[nodiscard]] PublishSettings read_publish_settings(const TomlTable& table,
                                                    const std::filesystem::path& folder);
[[nodiscard]] CollectSettings load_collect_settings(const std::filesystem::path& file);

[[nodiscard]] std::vector<OptionText> publish_options();  ///< of [publish]
[[nodiscard]] std::vector<OptionText> collect_options();  ///< of [collect]

}  // namespace sweepd
