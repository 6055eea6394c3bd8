#include "daemon/settings/plant_settings.hpp"

#include <charconv>

#include "daemon/settings/option.hpp"
#include "daemon/settings/toml_table.hpp"

namespace sweepd {
namespace {

constexpr std::string_view kCollect = "collect";

Options options_of(BrokerSettings& broker) {
  return {
      required(after_restart({"broker", &broker.address, "the MQTT broker; mqtts:// is with TLS"})),
      after_restart({"user", &broker.user, "the name that the broker asks for"}),
      after_restart({"password_file", &broker.password_file,
                     "holds the password; left out, the credential mqtt-password of the unit"}),
      after_restart({"ca_file", &broker.ca_file,
                     "certificates that the broker's must come from; left out, the system's"}),
      after_restart({"certificate_file", &broker.certificate_file,
                     "the certificate that the broker asks for"}),
      after_restart(
          {"key_file", &broker.key_file,
           "the private key of `certificate_file`; left out, the credential mqtt-key of the unit"}),
  };
}

Options options_of(PublishSettings& publish) {
  Options options = options_of(publish.broker);
  options.insert(
      options.begin() + 1,
      {required(after_restart({"site", &publish.site, "the plant, the second part of all topics"})),
       required(after_restart(
           {"cell", &publish.cell, "the cell or hall of this machine, the third part"}))});
  options.push_back(after_restart(
      {"spool", &publish.spool, "folder of what is on its way, and of what has arrived"}));
  return options;
}

Options options_of(CollectSettings& collect) {
  Options options = options_of(collect.broker);
  options.insert(
      options.begin() + 1,
      required(after_restart({"database", &collect.database,
                              "PostgreSQL's connection string: host=, dbname=, user=, …"})));
  options.push_back(after_restart(
      {"client", &collect.client,
       "its name at the broker, unique there; of another name, what waits for this one is lost"}));
  options.push_back(
      after_restart({"spool", &collect.spool, "folder of what has come and is not stored yet"}));
  return options;
}

}  // namespace

std::optional<BrokerAddress> parse_broker(std::string_view text) {
  constexpr std::string_view kPlain = "mqtt://", kTls = "mqtts://";
  BrokerAddress broker;
  broker.tls = text.starts_with(kTls);
  if (!broker.tls && !text.starts_with(kPlain)) return std::nullopt;
  text.remove_prefix(broker.tls ? kTls.size() : kPlain.size());
  broker.port = broker.tls ? 8883 : 1883;
  const auto colon = text.find(':');
  if (colon != text.npos) {
    const auto digits = text.substr(colon + 1);
    const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), broker.port);
    if (end.ec != std::errc{} || end.ptr != digits.data() + digits.size() || broker.port == 0)
      return std::nullopt;
  }
  broker.host = text.substr(0, colon);
  if (broker.host.empty() || broker.host.find_first_of("/ @?#") != std::string::npos)
    return std::nullopt;
  return broker;
}

std::string text(const BrokerAddress& broker) {
  return (broker.tls ? "mqtts://" : "mqtt://") + broker.host + ':' + std::to_string(broker.port);
}

PublishSettings read_publish_settings(const TomlTable& table, const std::filesystem::path& folder) {
  PublishSettings publish;
  read_options(table, options_of(publish), {}, folder);
  return publish;
}

CollectSettings load_collect_settings(const std::filesystem::path& file) {
  const TomlTable top = TomlTable::load(file);
  top.allow_only({kCollect});
  const auto table = top.table(kCollect);
  if (!table)
    top.fail(kCollect,
             "expected a table, found nothing: add [collect] with `broker` and `database`");
  CollectSettings collect;
  read_options(*table, options_of(collect), {}, file.parent_path());
  return collect;
}

std::vector<OptionText> publish_options() {
  PublishSettings defaults;
  return option_texts(options_of(defaults));
}

std::vector<OptionText> collect_options() {
  CollectSettings defaults;
  return option_texts(options_of(defaults));
}

}  // namespace sweepd
