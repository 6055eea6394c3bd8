#include "rsi/capture/packet.hpp"

#include <random>

#include "tests/catch.hpp"
#include "tests/rsi/addresses.hpp"
#include "tests/rsi/capture_bytes.hpp"

using namespace rsi::test;
using rsi::Datagram;
using rsi::decode_packet;
using rsi::Endpoint;
using rsi::LinkLayer;
using rsi::PacketKind;

namespace {

const std::string kShortTelegram = "<Rob Type=\"KUKA\"><IPOC>123</IPOC></Rob>\n";

void check_decodes(LinkLayer layer, std::string_view packet) {
  Datagram datagram;
  REQUIRE(decode_packet(layer, packet, datagram) == PacketKind::udp);
  CHECK(datagram.source == kController);
  CHECK(datagram.destination == kServer);
  CHECK(datagram.payload == kShortTelegram);
  CHECK_FALSE(datagram.cut);
}

PacketKind kind_of(LinkLayer layer, std::string_view packet) {
  Datagram datagram;
  return decode_packet(layer, packet, datagram);
}

}  // namespace

TEST_CASE("a datagram is found behind every known link header", "[packet]") {
  const auto ip = ipv4_udp(kController, kServer, kShortTelegram);
  check_decodes(LinkLayer::ethernet, ethernet(ip));
  check_decodes(LinkLayer::raw_ip, ip);
  check_decodes(LinkLayer::loopback, loopback(ip, Order::little_endian));
  check_decodes(LinkLayer::loopback, loopback(ip, Order::big_endian));
  check_decodes(LinkLayer::linux_sll, linux_sll(ip));
  check_decodes(LinkLayer::linux_sll2, linux_sll2(ip));
}

TEST_CASE("a segment of TCP is decoded where it is asked for", "[packet]") {
  const auto tcp = number(kController.port, 2) + number(kServer.port, 2) + number(0xfffffff0, 4) +
                   number(7, 4) + number(0x6002, 2) + std::string(6, '\0') + std::string(4, '\1') +
                   kShortTelegram;
  const auto packet = ethernet(ipv4(kController.address, kServer.address, tcp, {.protocol = 6}));
  CHECK(kind_of(LinkLayer::ethernet, packet) == PacketKind::foreign);
  Datagram datagram;
  rsi::PacketHeaders headers;
  REQUIRE(decode_packet(LinkLayer::ethernet, packet, datagram, &headers) == PacketKind::tcp);
  CHECK(datagram.source == kController);
  CHECK(datagram.destination == kServer);
  CHECK(datagram.payload == kShortTelegram);
  CHECK(headers.sequence == 0xfffffff0);
  CHECK(headers.begins);
  CHECK(decode_packet(LinkLayer::ethernet, packet.substr(0, 50), datagram, &headers) ==
        PacketKind::incomplete);
}

TEST_CASE("VLAN tags are skipped, however many are stacked", "[packet]") {
  const auto ip = ipv4_udp(kController, kServer, kShortTelegram);
  check_decodes(LinkLayer::ethernet, ethernet(ip, {0x8100}));
  check_decodes(LinkLayer::ethernet, ethernet(ip, {0x88a8, 0x8100}));
  check_decodes(LinkLayer::ethernet, ethernet(ip, {0x9100, 0x88a8, 0x8100, 0x8100}));
}

TEST_CASE("IP options and padding behind the datagram do not belong to the payload", "[packet]") {
  const auto with_options = ipv4(kController.address, kServer.address,
                                 udp_bytes(kController.port, kServer.port, kShortTelegram),
                                 {.options = std::string(8, '\x01')});
  check_decodes(LinkLayer::raw_ip, with_options);
  const auto padded = ethernet(ipv4_udp(kController, kServer, "x")) + std::string(17, '\0');
  Datagram datagram;
  REQUIRE(decode_packet(LinkLayer::ethernet, padded, datagram) == PacketKind::udp);
  CHECK(datagram.payload == "x");
}

TEST_CASE("an empty datagram is a datagram", "[packet]") {
  Datagram datagram;
  REQUIRE(decode_packet(LinkLayer::raw_ip, ipv4_udp(kController, kServer, ""), datagram) ==
          PacketKind::udp);
  CHECK(datagram.payload.empty());
  CHECK_FALSE(datagram.cut);
}

TEST_CASE("a packet that ends early is cut in the payload and incomplete in the headers",
          "[packet]") {
  const auto packet = ethernet(ipv4_udp(kController, kServer, kShortTelegram), {0x8100});
  const std::size_t headers = 14 + 4 + 20 + 8;
  for (std::size_t size = 0; size < packet.size(); ++size) {
    CAPTURE(size);
    Datagram datagram;
    const auto kind =
        decode_packet(LinkLayer::ethernet, std::string_view(packet).substr(0, size), datagram);
    if (size < headers) {
      CHECK(kind == PacketKind::incomplete);
    } else {
      REQUIRE(kind == PacketKind::udp);
      CHECK(datagram.cut);
      CHECK(datagram.payload == kShortTelegram.substr(0, size - headers));
    }
  }
}

TEST_CASE("fragments are told from whole datagrams", "[packet]") {
  const auto first = udp_bytes(kController.port, kServer.port, kShortTelegram);
  const auto fragment = [&](std::uint16_t flags_and_offset) {
    return ipv4(kController.address, kServer.address, first,
                {.flags_and_offset = flags_and_offset});
  };
  CHECK(kind_of(LinkLayer::raw_ip, fragment(0x2000)) == PacketKind::fragment);  // the first
  CHECK(kind_of(LinkLayer::raw_ip, fragment(0x20b9)) == PacketKind::fragment);
  CHECK(kind_of(LinkLayer::raw_ip, fragment(0x00b9)) == PacketKind::fragment);  // the last
  CHECK(kind_of(LinkLayer::raw_ip, fragment(0x4000)) == PacketKind::udp);       // don't fragment
}

TEST_CASE("other protocols are foreign", "[packet]") {
  const auto ip = ipv4_udp(kController, kServer, kShortTelegram);
  const auto tcp =
      ipv4(kController.address, kServer.address, std::string(20, '\x01'), {.protocol = 6});
  CHECK(kind_of(LinkLayer::ethernet, ethernet(tcp)) == PacketKind::foreign);
  CHECK(kind_of(LinkLayer::ethernet, ethernet(std::string(28, '\x01'), {}, 0x0806)) ==
        PacketKind::foreign);  // ARP
  const auto ipv6 = std::string(1, '\x60') + std::string(60, '\0');
  CHECK(kind_of(LinkLayer::ethernet, ethernet(ipv6, {}, 0x86dd)) == PacketKind::foreign);
  CHECK(kind_of(LinkLayer::raw_ip, ipv6) == PacketKind::foreign);
  CHECK(kind_of(LinkLayer::loopback, loopback(ip, Order::little_endian, 30)) ==
        PacketKind::foreign);
}

TEST_CASE("headers that contradict themselves are foreign", "[packet]") {
  const auto good = ipv4_udp(kController, kServer, kShortTelegram);
  const auto with = [&](std::size_t at, std::string_view bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  CHECK(kind_of(LinkLayer::raw_ip, with(0, "\x44")) == PacketKind::foreign);  // 16 bytes of header
  CHECK(kind_of(LinkLayer::raw_ip, with(2, number(27, 2))) == PacketKind::foreign);
  CHECK(kind_of(LinkLayer::raw_ip, with(2, number(0, 2))) == PacketKind::foreign);
  CHECK(kind_of(LinkLayer::raw_ip, with(24, number(7, 2))) == PacketKind::foreign);
}

TEST_CASE("a UDP header that announces more than the IP packet holds marks the datagram as cut",
          "[packet]") {
  auto packet = ipv4_udp(kController, kServer, kShortTelegram);
  packet.replace(24, 2, number(8 + kShortTelegram.size() + 1, 2));
  Datagram datagram;
  packet += "beyond";
  REQUIRE(decode_packet(LinkLayer::raw_ip, packet, datagram) == PacketKind::udp);
  CHECK(datagram.payload == kShortTelegram);
  CHECK(datagram.cut);
}

TEST_CASE("any bytes are decoded without reading beyond them", "[packet]") {
  std::mt19937 random(2718);
  const auto good = ethernet(ipv4_udp(kController, kServer, kShortTelegram), {0x8100});
  std::uint64_t datagrams = 0;
  for (int i = 0; i < 100'000; ++i) {
    std::string packet = good.substr(i % 2 == 0 ? 0 : 18);
    packet.resize(random() % (packet.size() + 1));
    packet.shrink_to_fit();
    for (int errors = 0; errors < 3 && !packet.empty(); ++errors)
      packet[random() % packet.size()] = static_cast<char>(random());
    for (const auto layer : {LinkLayer::ethernet, LinkLayer::raw_ip, LinkLayer::loopback,
                             LinkLayer::linux_sll, LinkLayer::linux_sll2}) {
      Datagram datagram;
      if (decode_packet(layer, packet, datagram) != PacketKind::udp) continue;
      ++datagrams;
      const auto* begin = packet.data();
      REQUIRE((datagram.payload.data() >= begin &&
               datagram.payload.data() + datagram.payload.size() <= begin + packet.size()));
    }
  }
  CHECK(datagrams > 10'000);  // the errors were not so many that nothing was tried
}

TEST_CASE("an encoded datagram is decoded to itself, whatever its length", "[packet]") {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{365}, rsi::max_udp_payload}) {
    CAPTURE(size);
    const std::string payload(size, 'x');
    std::string packet;
    CHECK(rsi::append_packet({{}, kController, kServer, payload, false}, packet) == 28 + size);
    Datagram datagram;
    REQUIRE(decode_packet(LinkLayer::raw_ip, packet, datagram) == PacketKind::udp);
    CHECK(datagram.source == kController);
    CHECK(datagram.destination == kServer);
    CHECK(datagram.payload == payload);
    CHECK_FALSE(datagram.cut);
  }
}

TEST_CASE("an encoded datagram that was cut stays cut", "[packet]") {
  std::string packet;
  const auto wire_length =
      rsi::append_packet({{}, kController, kServer, kShortTelegram, true}, packet);
  CHECK(wire_length == packet.size() + 1);
  Datagram datagram;
  REQUIRE(decode_packet(LinkLayer::raw_ip, packet, datagram) == PacketKind::udp);
  CHECK(datagram.payload == kShortTelegram);
  CHECK(datagram.cut);
}

TEST_CASE("the checksums of an encoded datagram are those of the standards", "[packet]") {
  // A receiver adds up all words, checksum and pseudo header included, and gets 0xffff (RFC 1071).
  const auto folded_sum = [](const std::string& bytes) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      sum += static_cast<unsigned char>(bytes[i]) * (i % 2 == 0 ? 256u : 1u);
    while (sum >> 16 != 0) sum = (sum & 0xffff) + (sum >> 16);
    return sum;
  };
  std::mt19937 random(31415);
  for (std::size_t size = 0; size < 300; ++size) {
    std::string payload;
    for (std::size_t i = 0; i < size; ++i) payload += static_cast<char>(random());
    const auto address = [&] { return static_cast<std::uint32_t>(random()); };
    const auto port = [&] { return static_cast<std::uint16_t>(random()); };
    std::string packet;
    rsi::append_packet({{}, {address(), port()}, {address(), port()}, payload, false}, packet);
    CHECK(folded_sum(packet.substr(0, 20)) == 0xffff);
    const auto pseudo_header = packet.substr(12, 8) + number(17, 2) + number(8 + size, 2);
    CHECK(folded_sum(pseudo_header + packet.substr(20)) == 0xffff);
  }
}

TEST_CASE("a UDP checksum of zero is sent as its other form, since zero means none", "[packet]") {
  // With all fields zero the words add up to 17 + 10 + 10 and the payload; it makes them 0xffff.
  std::string packet;
  rsi::append_packet({{}, {0, 0}, {0, 0}, number(0xffff - 37, 2), false}, packet);
  CHECK(packet.substr(26, 2) == "\xff\xff");
}
