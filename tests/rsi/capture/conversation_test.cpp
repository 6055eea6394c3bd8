#include "rsi/capture/conversation.hpp"

#include "rsi/capture/capture_reader.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/addresses.hpp"
#include "tests/rsi/capture_bytes.hpp"

using namespace rsi::test;
using namespace std::chrono_literals;
using Catch::Matchers::ContainsSubstring;
using rsi::Conversation;
using rsi::Direction;
using rsi::Endpoint;
using rsi::find_conversation;
using rsi::looks_like_telegram;

namespace {

const Endpoint other_controller{0xc0a80115, 1027};
const Endpoint other_sweepd{0xc0a8010a, 59152};
const Endpoint kOtherMachine{0xc0a80163, 5353};

const std::string kTelegram = "<Rob Type=\"KUKA\"><RIst X=\"1.0\"/><IPOC>123</IPOC></Rob>\n";
const std::string kReply = "<Sen Type=\"ImFree\"><IPOC>123</IPOC></Sen>";

class Traffic {
 public:
  Traffic& add(int count, const Endpoint& from, const Endpoint& to, std::string_view payload) {
    for (int i = 0; i < count; ++i) bytes_.add(time_ += 4ms, ipv4_udp(from, to, payload));
    return *this;
  }
  /// A telegram and its reply, `count` times.
  Traffic& talk(int count, const Endpoint& from, const Endpoint& to) {
    for (int i = 0; i < count; ++i) add(1, from, to, kTelegram).add(1, to, from, kReply);
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_.bytes(); }

 private:
  PcapBytes bytes_{link_raw};
  rsi::Timestamp time_ = 1'700'000'000s;
};

rsi::ConversationSearch search(const Traffic& traffic, const rsi::ConversationFilter& filter = {},
                               std::uint64_t limit = 20'000) {
  const TemporaryFile file(traffic.bytes());
  const std::filesystem::path paths[] = {file.path()};
  return find_conversation(paths, filter, limit);
}

Direction direction(const Conversation& conversation, const Endpoint& from, const Endpoint& to) {
  return conversation.direction({{}, from, to, "any payload", false});
}

}  // namespace

TEST_CASE("telegrams of every generation look like telegrams", "[conversation]") {
  for (const auto* payload :
       {"<Rob Type=\"KUKA\"><IPOC>1</IPOC></Rob>", "<Rob TYPE=\"KUKA\">", "<Rob>", "<rob>",
        "<ROB\t>", "<Rob\nType=\"KUKA\">", " \r\n\t<Rob Type=\"KUKA\">",
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- RSI --><Rob Type=\"KUKA\">",
        "<IPOC>123456</IPOC>", "<ipoc>123456</ipoc>\n", "<Rob Type=\"KUKA\" GPIO.01="})
    CHECK(looks_like_telegram(payload));
}

TEST_CASE("replies and other traffic do not look like telegrams", "[conversation]") {
  for (const auto* payload :
       {"", "<", "<Rob", "Rob ", "<Robot>", "<Sen Type=\"ImFree\"><IPOC>1</IPOC></Sen>",
        "<sen><ipoc>1</ipoc></sen>", "M-SEARCH * HTTP/1.1\r\n", "\xff\xfe<R\0o\0b"})
    CHECK_FALSE(looks_like_telegram(payload));
  CHECK_FALSE(looks_like_telegram(std::string(300, ' ') + kTelegram));
  CHECK_FALSE(looks_like_telegram("<IPOC>1</IPOC>" + std::string(100, ' ')));
}

TEST_CASE("the direction follows from addresses, whatever the controller's port and the payload",
          "[conversation]") {
  const Conversation conversation{kController.address, kServer};
  CHECK(direction(conversation, kController, kServer) == Direction::from_controller);
  CHECK(direction(conversation, {kController.address, 2000}, kServer) ==
        Direction::from_controller);
  CHECK(direction(conversation, kServer, kController) == Direction::to_controller);
  CHECK(direction(conversation, kServer, {kController.address, 2000}) == Direction::to_controller);
  CHECK(direction(conversation, kOtherMachine, kServer) == Direction::other);
  CHECK(direction(conversation, kServer, kOtherMachine) == Direction::other);
  CHECK(direction(conversation, kController, other_sweepd) == Direction::other);
  CHECK(direction(conversation, kController, {kOtherMachine.address, kServer.port}) ==
        Direction::other);
}

TEST_CASE("on loopback the direction follows from the port", "[conversation]") {
  const std::uint32_t here = 0x7f000001;
  const Endpoint client{here, 40000}, server{here, 49152};
  const auto found = search(Traffic().talk(3, client, server));
  REQUIRE(found.chosen);
  CHECK(*found.chosen == Conversation{here, server});
  CHECK(direction(*found.chosen, client, server) == Direction::from_controller);
  CHECK(direction(*found.chosen, server, client) == Direction::to_controller);
  CHECK(direction(*found.chosen, client, {here, 40001}) == Direction::other);
}

TEST_CASE("the RSI conversation is found among other traffic", "[conversation]") {
  Traffic traffic;
  traffic.add(100, kOtherMachine, kServer, "something else").talk(5, kController, kServer);
  traffic.add(100, kController, kOtherMachine, "<Robots are not telegrams/>");
  const auto found = search(traffic);
  REQUIRE(found.chosen);
  CHECK(*found.chosen == Conversation{kController.address, kServer});
  REQUIRE(found.found.size() == 1);
  CHECK(found.found[0].telegrams == 5);
  CHECK(found.note.empty());
}

TEST_CASE("a controller that comes back with another port goes on in the same conversation",
          "[conversation]") {
  Traffic traffic;
  traffic.talk(3, kController, kServer).talk(4, {kController.address, 1028}, kServer);
  const auto found = search(traffic);
  REQUIRE(found.found.size() == 1);
  CHECK(found.found[0].telegrams == 7);
}

TEST_CASE("of two conversations the busier is taken, and the user is told of both",
          "[conversation]") {
  Traffic traffic;
  traffic.talk(3, kController, kServer).talk(4, other_controller, other_sweepd);
  const auto found = search(traffic);
  REQUIRE(found.chosen);
  CHECK(*found.chosen == Conversation{other_controller.address, other_sweepd});
  REQUIRE(found.found.size() == 2);
  CHECK(found.found[0].conversation == Conversation{kController.address, kServer});
  CHECK(found.found[0].telegrams == 3);
  CHECK(
      found.note ==
      "2 RSI conversations; taken: 192.168.1.21 with 192.168.1.10:59152 (4 telegrams), not taken: "
      "192.168.1.20 with 192.168.1.10:49152 (3 telegrams): choose another by --port or "
      "--controller");
}

TEST_CASE("of two equally busy conversations the first is taken", "[conversation]") {
  Traffic traffic;
  for (int i = 0; i < 3; ++i)
    traffic.talk(1, other_controller, kServer).talk(1, kController, kServer);
  const auto found = search(traffic);
  REQUIRE(found.chosen);
  CHECK(found.chosen->controller == other_controller.address);
}

TEST_CASE("of many conversations a few are listed", "[conversation]") {
  Traffic traffic;
  for (std::uint16_t port = 1; port <= 20; ++port)
    traffic.talk(1, kController, {kServer.address, port});
  const auto found = search(traffic);
  CHECK(found.found.size() == 20);
  CHECK_THAT(found.note, ContainsSubstring("20 RSI conversations") &&
                             ContainsSubstring(" and 11 more: choose"));
}

TEST_CASE("the busiest conversation is found behind any number of strangers", "[conversation]") {
  Traffic traffic;
  for (std::uint32_t k = 0; k < 300; ++k) traffic.talk(1, {0x0a000000 + k, 5000}, kServer);
  traffic.talk(50, kController, kServer);
  const auto found = search(traffic, {}, 100);
  CHECK(found.chosen == Conversation{kController.address, kServer});
}

TEST_CASE("the user chooses by port, by controller or by both", "[conversation]") {
  Traffic traffic;
  traffic.talk(3, kController, kServer).talk(4, other_controller, other_sweepd);
  traffic.talk(2, other_controller, kServer);
  const auto by_port = search(traffic, {.port = 49152});
  REQUIRE(by_port.chosen);
  CHECK(*by_port.chosen == Conversation{kController.address, kServer});
  CHECK_THAT(by_port.note, ContainsSubstring("2 RSI conversations") && !ContainsSubstring("59152"));

  const auto by_controller = search(traffic, {.controller = kController.address});
  REQUIRE(by_controller.chosen);
  CHECK(*by_controller.chosen == Conversation{kController.address, kServer});
  CHECK(by_controller.note.empty());

  const auto by_both = search(traffic, {.port = 49152, .controller = other_controller.address});
  REQUIRE(by_both.chosen);
  CHECK(*by_both.chosen == Conversation{other_controller.address, kServer});
}

TEST_CASE("a choice that is not there is answered with what is there", "[conversation]") {
  const auto found = search(Traffic().talk(3, kController, kServer), {.port = 6008});
  CHECK_FALSE(found.chosen);
  REQUIRE(found.found.size() == 1);
  CHECK_FALSE(found.found[0].admitted);
  CHECK(found.note ==
        "no RSI conversation on port 6008, but 192.168.1.20 with 192.168.1.10:49152 (3 telegrams): "
        "choose one of these by --port or --controller");
}

TEST_CASE("captures without RSI are said to be so", "[conversation]") {
  const auto found = search(Traffic().add(7, kOtherMachine, kServer, "something else"));
  CHECK_FALSE(found.chosen);
  CHECK(found.found.empty());
  CHECK_THAT(found.note,
             ContainsSubstring("no RSI among 7 UDP datagrams") && ContainsSubstring("capture on"));

  PcapBytes foreign(link_raw);
  for (int k = 0; k < 3; ++k) foreign.add(1'700'000'000s, '\x60' + std::string(39, '\0'));  // IPv6
  const TemporaryFile of_foreign(foreign.bytes());
  CHECK_THAT(find_conversation(std::vector{of_foreign.path()}).note,
             ContainsSubstring("none of 3 packets is UDP over IPv4"));

  auto cut = Traffic().talk(1, kController, kServer).bytes();
  cut.resize(50);
  const TemporaryFile file(cut);
  const std::filesystem::path paths[] = {file.path()};
  CHECK_THAT(find_conversation(paths).note,
             ContainsSubstring("no RSI") && ContainsSubstring("is cut off"));
}

TEST_CASE("the search ends once enough telegrams were seen, counting only those that are wanted",
          "[conversation]") {
  Traffic traffic;
  traffic.talk(10, kController, kServer).talk(50, other_controller, kServer);
  const auto ended = search(traffic, {}, 10);
  REQUIRE(ended.chosen);
  CHECK(ended.chosen->controller == kController.address);
  CHECK(ended.found.size() == 1);

  const auto wanted = search(traffic, {.controller = other_controller.address}, 10);
  REQUIRE(wanted.chosen);
  CHECK(wanted.chosen->controller == other_controller.address);
  CHECK(wanted.found.back().telegrams == 10);
}

TEST_CASE("captures given together are searched together", "[conversation]") {
  const TemporaryFile first(
      Traffic().talk(3, kController, kServer).talk(2, other_controller, kServer).bytes());
  const TemporaryFile second(Traffic().talk(2, other_controller, kServer).bytes());
  const std::filesystem::path paths[] = {first.path(), second.path()};
  const auto found = find_conversation(paths);
  REQUIRE(found.chosen);
  CHECK(found.chosen->controller == other_controller.address);
  CHECK(found.found.back().telegrams == 4);
}

TEST_CASE("a capture that cannot be opened is an exception, also behind one that can",
          "[conversation]") {
  const TemporaryFile first(Traffic().talk(3, kController, kServer).bytes());
  const std::filesystem::path paths[] = {first.path(), "/nowhere/trace.pcap"};
  CHECK_THROWS_AS(find_conversation(paths), rsi::CaptureError);
  CHECK_THROWS_AS(find_conversation(paths, {}, 1), rsi::CaptureError);
}
