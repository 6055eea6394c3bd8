#include "rsi/capture/capture_reader.hpp"

#include <random>

#include "rsi/counted.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/addresses.hpp"
#include "tests/rsi/capture_bytes.hpp"

using namespace rsi::test;
using namespace std::chrono_literals;
using Catch::Matchers::ContainsSubstring;
using rsi::CaptureError;
using rsi::CaptureReader;
using rsi::Endpoint;
using rsi::Timestamp;
using Paths = std::vector<std::filesystem::path>;

namespace {

std::string numbered_telegram(int number) {
  return "<Rob Type=\"KUKA\"><IPOC>" + std::to_string(4 * number) + "</IPOC></Rob>\n";
}

std::string ip_packet(int number) {
  return ipv4_udp(kController, kServer, numbered_telegram(number));
}

std::vector<std::string> payloads(CaptureReader& reader) {
  std::vector<std::string> all;
  while (const auto datagram = reader.next()) all.emplace_back(datagram->payload);
  return all;
}

/// Two packets around those of `frame`; both must come back, with times of this resolution.
template <typename Bytes>
void check_reads_two(Bytes bytes, std::string (*frame)(std::string_view), Timestamp resolution) {
  bytes.add(kCaptured, frame(ip_packet(1)));
  bytes.add(kCaptured + 4ms, frame(ip_packet(2)));
  const TemporaryFile file(bytes.bytes());
  CaptureReader reader(file.path());
  for (int i = 1; i <= 2; ++i) {
    const auto datagram = reader.next();
    REQUIRE(datagram);
    const auto time = kCaptured + 4ms * (i - 1);
    CHECK(datagram->time == time / resolution * resolution);
    CHECK(datagram->source == kController);
    CHECK(datagram->destination == kServer);
    CHECK(datagram->payload == numbered_telegram(i));
    CHECK_FALSE(datagram->cut);
  }
  CHECK_FALSE(reader.next());
  CHECK_FALSE(reader.next());
  CHECK(reader.counters().packets == 2);
  CHECK(reader.counters().udp == 2);
  CHECK(reader.bytes_read() == bytes.bytes().size());
  CHECK(reader.notes().empty());
}

struct Link {
  std::uint32_t type;
  std::string (*frame)(std::string_view);
};

const Link links[] = {
    {link_ethernet, [](std::string_view ip) { return ethernet(ip); }},
    {link_ethernet,
     [](std::string_view ip) {
       return ethernet(ip, {0x88a8, 0x8100});
     }},
    {link_raw, [](std::string_view ip) { return std::string(ip); }},
    {12, [](std::string_view ip) { return std::string(ip); }},
    {link_ipv4, [](std::string_view ip) { return std::string(ip); }},
    {link_null, [](std::string_view ip) { return loopback(ip, Order::little_endian); }},
    {link_null, [](std::string_view ip) { return loopback(ip, Order::big_endian); }},
    {link_loop, [](std::string_view ip) { return loopback(ip, Order::big_endian); }},
    {link_sll, linux_sll},
    {link_sll2, linux_sll2},
};

void check_refused(std::string_view content, const std::string& reason) {
  const TemporaryFile file(content);
  CHECK_THROWS_WITH(CaptureReader(file.path()),
                    ContainsSubstring(file.path().string()) && ContainsSubstring(reason));
  CHECK_THROWS_AS(CaptureReader(file.path()), CaptureError);
}

}  // namespace

TEST_CASE("captures of every format, byte order and link type are read", "[capture_reader]") {
  for (const auto& [type, frame] : links)
    for (const auto order : {Order::little_endian, Order::big_endian})
      for (const bool fine : {true, false}) {
        CAPTURE(type, order == Order::big_endian, fine);
        const auto resolution = fine ? Timestamp(1ns) : Timestamp(1us);
        check_reads_two(PcapBytes(type, fine, order), frame, resolution);
        check_reads_two(PcapngBytes(order).add_interface(type, fine), frame, resolution);
      }
}

TEST_CASE("a capture cut at any byte gives the whole packets before the cut and says so",
          "[capture_reader]") {
  const auto cut_everywhere = [](const auto& empty, std::size_t packets) {
    auto bytes = empty;
    std::vector<std::size_t> ends = {bytes.bytes().size()};
    for (std::size_t i = 0; i < packets; ++i) {
      bytes.add(kCaptured, ethernet(ip_packet(static_cast<int>(i))));
      ends.push_back(bytes.bytes().size());
    }
    for (std::size_t size = 0; size <= ends.back(); ++size) {
      CAPTURE(size);
      const TemporaryFile file(std::string_view(bytes.bytes()).substr(0, size));
      if (size < ends.front()) {
        CHECK_THROWS_AS(CaptureReader(file.path()), CaptureError);
        continue;
      }
      CaptureReader reader(file.path());
      const auto read = payloads(reader);
      std::size_t whole = 0;
      while (whole < packets && ends[whole + 1] <= size) ++whole;
      REQUIRE(read.size() == whole);
      for (std::size_t i = 0; i < whole; ++i)
        CHECK(read[i] == numbered_telegram(static_cast<int>(i)));
      if (ends[whole] == size) {
        CHECK(reader.notes().empty());
      } else {
        REQUIRE(reader.notes().size() == 1);
        CHECK_THAT(reader.notes()[0], ContainsSubstring(file.path().string() + ": is cut off") &&
                                          ContainsSubstring(rsi::counted(whole, "packet")));
      }
    }
  };
  cut_everywhere(PcapBytes(), 3);
  cut_everywhere(PcapngBytes().add_interface(link_ethernet), 3);
}

TEST_CASE("damaged and random bytes are read without harm", "[capture_reader]") {
  std::mt19937 random(1618);
  PcapBytes pcap;
  PcapngBytes pcapng(Order::big_endian);
  pcapng.add_interface(link_ethernet);
  for (int i = 0; i < 5; ++i) {
    pcap.add(kCaptured, ethernet(ip_packet(i)));
    pcapng.add(kCaptured, ethernet(ip_packet(i)));
  }
  int opened = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = i % 2 == 0 ? pcap.bytes() : pcapng.bytes();
    if (i % 10 == 9) {
      const std::size_t magic = 4;  // let it get past the first look
      for (std::size_t at = magic; at < bytes.size(); ++at) bytes[at] = static_cast<char>(random());
    }
    for (int errors = 0; errors < 4; ++errors)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    const TemporaryFile file(bytes);
    try {
      CaptureReader reader(file.path());
      ++opened;
      payloads(reader);
      for (const auto& note : reader.notes()) REQUIRE_FALSE(note.empty());
      const auto& counters = reader.counters();
      REQUIRE(counters.udp + counters.fragments + counters.foreign <= counters.packets);
    } catch (const CaptureError&) {
    }
  }
  CHECK(opened > 1000);  // the errors were not so many that nothing was tried
}

TEST_CASE("a snapped datagram is handed out as cut, and the notes say so", "[capture_reader]") {
  PcapBytes bytes;
  const auto frame = ethernet(ip_packet(1));
  const std::size_t headers = 14 + 28;
  bytes.add(kCaptured, frame, headers + 10);
  bytes.add(kCaptured, frame, headers - 1);  // nothing of it can be handed out
  bytes.add(kCaptured, frame);
  const TemporaryFile file(bytes.bytes());
  CaptureReader reader(file.path());
  const auto cut = reader.next();
  REQUIRE(cut);
  CHECK(cut->cut);
  CHECK(cut->payload == numbered_telegram(1).substr(0, 10));
  const auto whole = reader.next();
  REQUIRE(whole);
  CHECK_FALSE(whole->cut);
  CHECK(whole->payload == numbered_telegram(1));
  CHECK_FALSE(reader.next());
  CHECK(reader.counters().udp == 2);
  CHECK(reader.counters().snapped == 2);
  CHECK(reader.counters().foreign == 0);
  REQUIRE(reader.notes().size() == 1);
  CHECK_THAT(reader.notes()[0], ContainsSubstring(file.path().string()) &&
                                    ContainsSubstring("of 2 datagrams") &&
                                    ContainsSubstring("-s 0"));
}

TEST_CASE("a packet that was snapped in its padding only is whole", "[capture_reader]") {
  PcapBytes bytes;
  const auto frame = ethernet(ip_packet(1));
  bytes.add(kCaptured, frame + std::string(20, '\0'), frame.size());
  const TemporaryFile file(bytes.bytes());
  CaptureReader reader(file.path());
  const auto datagram = reader.next();
  REQUIRE(datagram);
  CHECK(datagram->payload == numbered_telegram(1));
  CHECK_FALSE(datagram->cut);
  CHECK(reader.counters().snapped == 0);
}

TEST_CASE("fragments and foreign packets are passed over and counted", "[capture_reader]") {
  const auto payload = udp_bytes(kController.port, kServer.port, numbered_telegram(1));
  PcapBytes bytes;
  bytes.add(kCaptured, ethernet(ipv4(1, 2, payload, {.flags_and_offset = 0x2000})));
  bytes.add(kCaptured, ethernet(ipv4(1, 2, payload, {.flags_and_offset = 0x0010})));
  bytes.add(kCaptured, ethernet(ipv4(1, 2, std::string(20, 't'), {.protocol = 6})));
  bytes.add(kCaptured, ethernet(std::string(28, 'a'), {}, 0x0806));
  bytes.add(kCaptured, ethernet(std::string(1, '\x60') + std::string(60, '\0'), {}, 0x86dd));
  bytes.add(kCaptured, "short");
  bytes.add(kCaptured, "");
  bytes.add(kCaptured, ethernet(ip_packet(7)));
  const TemporaryFile file(bytes.bytes());
  CaptureReader reader(file.path());
  CHECK(payloads(reader) == std::vector{numbered_telegram(7)});
  CHECK(reader.counters().packets == 8);
  CHECK(reader.counters().udp == 1);
  CHECK(reader.counters().fragments == 2);
  CHECK(reader.counters().foreign == 5);
  REQUIRE(reader.notes().size() == 1);
  CHECK_THAT(reader.notes()[0], ContainsSubstring("2 IP fragments") && ContainsSubstring("SEND"));
}

TEST_CASE("pcapng interfaces of one link type are read as one capture", "[capture_reader]") {
  PcapngBytes bytes;
  bytes.add_interface(link_ethernet, true).add_interface(link_ethernet, false);
  bytes.add(kCaptured, ethernet(ip_packet(1)), SIZE_MAX, 0);
  bytes.add(kCaptured, ethernet(ip_packet(2)), SIZE_MAX, 1);
  bytes.add_block(5, std::string(12, '\0'));  // interface statistics
  const TemporaryFile file(bytes.bytes());
  CaptureReader reader(file.path());
  const auto first = reader.next();
  REQUIRE(first);
  CHECK(first->time == kCaptured);
  const auto second = reader.next();
  REQUIRE(second);
  CHECK(second->time == kCaptured - 789ns);
  CHECK_FALSE(reader.next());
  CHECK(reader.notes().empty());
}

TEST_CASE("pcapng interfaces of unlike link types end the reading with a remedy",
          "[capture_reader]") {
  PcapngBytes bytes;
  bytes.add_interface(link_ethernet).add(kCaptured, ethernet(ip_packet(1)));
  bytes.add_interface(link_null).add(kCaptured, ethernet(ip_packet(2)));
  const TemporaryFile file(bytes.bytes());
  CaptureReader reader(file.path());
  CHECK(payloads(reader) == std::vector{numbered_telegram(1)});
  REQUIRE(reader.notes().size() == 1);
  CHECK_THAT(reader.notes()[0], ContainsSubstring(file.path().string()) &&
                                    ContainsSubstring("unlike interfaces") &&
                                    ContainsSubstring("capture again on the one interface"));
}

TEST_CASE("all sections of a pcapng file are read, each as it was captured",
          "[capture_reader][issue11][point_14]") {
  PcapngBytes bytes;
  bytes.add_interface(link_ethernet).add(kCaptured, ethernet(ip_packet(1)));
  bytes.add_section(Order::little_endian).add_interface(link_ethernet);
  bytes.add(kCaptured + 4ms, ethernet(ip_packet(2)));
  bytes.add_section(Order::little_endian).add_interface(link_ethernet, true, 65535);
  bytes.add(kCaptured + 8ms, ethernet(ip_packet(3)));
  bytes.add_section(Order::big_endian).add_interface(link_ethernet, false);
  bytes.add(kCaptured + 12ms, ethernet(ip_packet(4)));
  bytes.add_section(Order::big_endian);  // nothing was captured
  bytes.add_section(Order::little_endian).add_interface(link_sll);
  bytes.add(kCaptured + 16ms, linux_sll(ip_packet(5)));
  const TemporaryFile file(bytes.bytes());
  CaptureReader reader(file.path());
  for (int i = 1; i <= 5; ++i) {
    CAPTURE(i);
    const auto datagram = reader.next();
    REQUIRE(datagram);
    CHECK(datagram->payload == numbered_telegram(i));
    CHECK(datagram->time == kCaptured + 4ms * (i - 1) - (i == 4 ? 789ns : 0ns));
  }
  CHECK_FALSE(reader.next());
  CHECK(reader.counters().packets == 5);
  CHECK(reader.bytes_read() == bytes.bytes().size());
  CHECK(reader.notes().empty());
}

TEST_CASE("a pcapng section that cannot be read does not hide the next one",
          "[capture_reader][issue11][point_14]") {
  PcapngBytes bytes;
  bytes.add_interface(link_ethernet).add(kCaptured, ethernet(ip_packet(1)));
  bytes.add_interface(link_null).add(kCaptured, ethernet(ip_packet(2)), SIZE_MAX, 1);
  bytes.add_section(Order::big_endian).add_interface(105).add(kCaptured, "wireless");
  bytes.add_section(Order::little_endian).add_interface(link_ethernet);
  bytes.add(kCaptured, ethernet(ip_packet(3)));
  const auto whole = bytes.bytes();
  const TemporaryFile file(
      bytes.add_section(Order::big_endian).bytes().substr(0, whole.size() + 9));
  CaptureReader reader(file.path());
  CHECK(payloads(reader) == std::vector{numbered_telegram(1), numbered_telegram(3)});
  REQUIRE(reader.notes().size() == 3);
  CHECK_THAT(reader.notes()[0], ContainsSubstring("unlike interfaces"));
  CHECK_THAT(reader.notes()[1],
             ContainsSubstring("type 105 (IEEE802_11)") && ContainsSubstring("section 2"));
  CHECK_THAT(reader.notes()[2], ContainsSubstring("section 4 is not a capture"));
}

TEST_CASE("what is no capture is refused with the file, the reason and a remedy",
          "[capture_reader]") {
  check_refused("", "is not a capture");
  check_refused("a line of text that is no capture\n", "pcap or pcapng");
  check_refused("\x1f\x8b\x08 compressed", "unpacked");
  check_refused(PcapBytes(105).bytes(), "type 105 (IEEE802_11), which is not understood");
  check_refused(PcapngBytes().add_interface(105).bytes(), "capture again");
  CHECK_THROWS_WITH(CaptureReader("/nowhere/trace.pcap"),
                    ContainsSubstring("cannot open capture /nowhere/trace.pcap: No such file"));
  CHECK_THROWS_WITH(CaptureReader(std::filesystem::temp_directory_path()),
                    ContainsSubstring("Is a directory"));
}

TEST_CASE("times that no clock can count do not overflow", "[capture_reader]") {
  PcapngBytes bytes;
  bytes.add_block(1, number(1, 2, Order::little_endian) + std::string(2, '\0') +
                         number(262144, 4, Order::little_endian) +
                         number(9, 2, Order::little_endian) + number(1, 2, Order::little_endian) +
                         std::string(4, '\0'));  // in seconds
  const auto frame = ethernet(ip_packet(1));
  const auto size = number(frame.size(), 4, Order::little_endian);
  bytes.add_block(6, std::string(4, '\0') + std::string(8, '\x7f') + size + size + frame);
  const TemporaryFile file(bytes.bytes());
  CaptureReader reader(file.path());
  const auto datagram = reader.next();
  REQUIRE(datagram);
  CHECK(datagram->time > 200 * 365 * 24h);
}

namespace {

std::string capture(rsi::Timestamp first) {
  PcapBytes bytes(link_raw);
  bytes.add(first, ipv4_udp({1, 2}, {3, 4}, "payload")).add(1h, ipv4_udp({1, 2}, {3, 4}, "last"));
  return bytes.bytes();
}

}  // namespace

TEST_CASE("captures come in the order of their first datagrams, empty ones last",
          "[capture_reader]") {
  const TemporaryFile second(capture(2s));
  const TemporaryFile empty(PcapBytes(link_raw).bytes());
  const TemporaryFile third(capture(3s));
  const TemporaryFile first(capture(1s));
  CHECK(rsi::in_order_of_time({second.path(), empty.path(), third.path(), first.path()}) ==
        Paths{first.path(), second.path(), third.path(), empty.path()});
  CHECK(rsi::in_order_of_time({}).empty());
}

TEST_CASE("one capture alone is not opened, of several one that does not open is an error",
          "[capture_reader]") {
  const TemporaryFile good(capture(1s));
  CHECK(rsi::in_order_of_time({"/nowhere.pcap"}) == Paths{"/nowhere.pcap"});
  CHECK_THROWS_AS(rsi::in_order_of_time({good.path(), "/nowhere.pcap"}), rsi::CaptureError);
}
