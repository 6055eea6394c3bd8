#include "daemon/plant/broker_link.hpp"

#include "daemon/settings/toml_table.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::BrokerLink;
using sweepd::ConfigError;
using sweepd::test::TemporaryFolder;

// Paho keeps the properties of each connection's options: LeakSanitizer tells them.
TEST_CASE(
    "a certificate or key that cannot be read is told with its setting, before any connection",
    "[broker_link][long]") {
  const TemporaryFolder folder;
  const auto made = [&](auto set) {
    BrokerLink::Options options;
    options.broker.address = {true, "localhost", 8883};
    options.client = "test";
    options.spool = folder / "spool";
    set(options.broker);
    const BrokerLink link(options, sweepd::Log("a"));
  };
  const auto is_refused = [&](auto set, const std::string& key) {
    CHECK_THROWS_AS(made(set), ConfigError);
    CHECK_THROWS_WITH(made(set), ContainsSubstring("none.pem: cannot be read: check `" + key));
  };
  const auto none = folder / "none.pem";
  is_refused([&](auto& broker) { broker.ca_file = none; }, "ca_file");
  is_refused([&](auto& broker) { broker.certificate_file = none; }, "certificate_file");
  is_refused([&](auto& broker) { broker.key_file = none; }, "key_file");
  const auto there = folder.write("ca.pem", "x");
  CHECK_NOTHROW(made([&](auto& broker) { broker.ca_file = there; }));
}
