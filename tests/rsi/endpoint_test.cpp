#include "rsi/endpoint.hpp"

#include "tests/catch.hpp"

TEST_CASE("an endpoint is read and printed as a person writes it", "[endpoint]") {
  const auto endpoint = rsi::parse_endpoint("192.168.1.20:49152");
  REQUIRE(endpoint);
  CHECK(endpoint->address == 0xc0a80114u);
  CHECK(endpoint->port == 49152);
  CHECK(rsi::text(*endpoint) == "192.168.1.20:49152");
  CHECK(rsi::address_text(*rsi::parse_address("0.0.0.0")) == "0.0.0.0");
}

TEST_CASE("what is not an endpoint is refused", "[endpoint]") {
  for (const auto* wrong :
       {"", "192.168.1", "192.168.1.20", "192.168.1.20:", "192.168.1.20:0", "192.168.1.256:1",
        "192.168.1.20:65536", "192.168.1.20:1 ", "host:1", "1.2.3.-4:5", "1..2.3:4", " 1.2.3.4:5"})
    CHECK_FALSE(rsi::parse_endpoint(wrong));
  CHECK_FALSE(rsi::parse_address("1.2.3.4:5"));
}
