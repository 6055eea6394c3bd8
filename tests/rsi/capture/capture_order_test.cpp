#include "rsi/capture/capture_order.hpp"

#include "rsi/capture/capture_reader.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/capture_bytes.hpp"

using namespace rsi::test;
using namespace std::chrono_literals;
using Paths = std::vector<std::filesystem::path>;

namespace {

std::string capture(rsi::Timestamp first) {
  PcapBytes bytes(link_raw);
  bytes.add(first, ipv4_udp({1, 2}, {3, 4}, "payload")).add(1h, ipv4_udp({1, 2}, {3, 4}, "last"));
  return bytes.bytes();
}

}  // namespace

TEST_CASE("captures come in the order of their first datagrams, empty ones last",
          "[capture_order]") {
  const TemporaryFile second(capture(2s));
  const TemporaryFile empty(PcapBytes(link_raw).bytes());
  const TemporaryFile third(capture(3s));
  const TemporaryFile first(capture(1s));
  CHECK(rsi::in_order_of_time({second.path(), empty.path(), third.path(), first.path()}) ==
        Paths{first.path(), second.path(), third.path(), empty.path()});
  CHECK(rsi::in_order_of_time({}).empty());
}

TEST_CASE("one capture alone is not opened, of several one that does not open is an error",
          "[capture_order]") {
  const TemporaryFile good(capture(1s));
  CHECK(rsi::in_order_of_time({"/nowhere.pcap"}) == Paths{"/nowhere.pcap"});
  CHECK_THROWS_AS(rsi::in_order_of_time({good.path(), "/nowhere.pcap"}), rsi::CaptureError);
}
