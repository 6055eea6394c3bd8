#include "rsi/server/server.hpp"

#include <string>
#include <utility>
#include <vector>

#include "rsi/telegram/ipoc.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/running_server.hpp"

using namespace std::chrono_literals;
using namespace rsi::test;
using rsi::Datagram;
using rsi::Endpoint;

namespace {

constexpr Endpoint kStray{0x0a000002, 7000};

/// A server without a network: what it is given has come together.
class BareServer : public rsi::Server {
 public:
  explicit BareServer(Options options = on_loopback()) : Server(with_clock(std::move(options))) {
    HandClock::time = 1h;
    set_local({kLoopback, 49152});
  }

  rsi::Transport transport() const noexcept override { return rsi::Transport::udp; }
  void run() noexcept override {}

  /// Gives what has come, each from its source, and returns the replies with where they went.
  std::vector<std::pair<Endpoint, std::string>> give(
      const std::vector<std::pair<Endpoint, std::string>>& all) {
    std::vector<Datagram> datagrams;
    for (const auto& [source, text] : all) datagrams.push_back({{}, source, local(), text});
    sent_.clear();
    serve(datagrams);
    heard_all_until(HandClock::now());
    return sent_;
  }
  /// Whether a telegram that comes alone is answered.
  bool answers(const Endpoint& source, std::uint64_t ipoc) {
    return give({{source, telegram(ipoc)}}).size() == 1;
  }
  void pass(std::chrono::milliseconds time) {
    HandClock::time = HandClock::time.load() + time;
    heard_all_until(HandClock::now());
  }

 private:
  void wake() noexcept override {}
  static Options with_clock(Options options) {
    options.clock = HandClock::now;
    return options;
  }
  bool send(std::string_view reply, const Datagram& telegram) noexcept override {
    sent_.emplace_back(telegram.source, reply);
    return true;
  }

  std::vector<std::pair<Endpoint, std::string>> sent_;
};

using Replies = std::vector<std::pair<Endpoint, std::string>>;

}  // namespace

TEST_CASE("of telegrams that wait together the newest is answered, in whatever order they came",
          "[server][issue11][point_9]") {
  BareServer bench;
  const auto newest = [&](const std::vector<std::uint64_t>& ipocs) {
    Replies telegrams;
    for (const auto ipoc : ipocs) telegrams.emplace_back(kController, telegram(ipoc));
    const auto replies = bench.give(telegrams);
    REQUIRE(replies.size() == 1);
    return *rsi::ipoc_number(rsi::find_ipoc(replies[0].second));
  };
  CHECK(newest({1004, 1008, 1012}) == 1012);
  CHECK(newest({1020, 1016}) == 1020);
  CHECK(newest({1024, 1020}) == 1024);  // came twice, and was answered before
  CHECK(newest({1028, 1028}) == 1028);
  CHECK(newest({1036, 1028, 1032}) == 1036);
  constexpr auto kGreatest = ~std::uint64_t{0};
  CHECK(newest({3, kGreatest}) == 3);  // behind the greatest number comes 0
  CHECK(newest({kGreatest, 3}) == 3);
  // RSI began anew: its IPOC falls back by more than a telegram can be overtaken by.
  CHECK(newest({900'000, 900'004, 40, 44}) == 44);
  CHECK(newest({48, 900'008}) == 900'008);
  CHECK(bench.counts().answered + bench.counts().superseded == 22);
}

TEST_CASE("RSI that began anew from another port is answered before a straggler of the old one",
          "[server][issue11][point_9]") {
  BareServer bench;
  CHECK(bench.answers(kController, 5000));
  const auto replies = bench.give({{kController, telegram(5004)},
                                   {kRestarted, telegram(4)},
                                   {kRestarted, telegram(8)},
                                   {kController, telegram(5008)}});
  CHECK(replies == Replies{{kRestarted, reply(8)}});
  CHECK(bench.answers(kRestarted, 12));
}

TEST_CASE("a telegram that was overtaken and comes alone is answered: RSI may have begun anew",
          "[server][issue11][point_9]") {
  BareServer bench;
  CHECK(bench.answers(kController, 1000));
  CHECK(bench.answers(kController, 996));
}

TEST_CASE("a stray datagram with an IPOC a second does not keep out the controller",
          "[server][issue11][point_8]") {
  BareServer bench;
  for (std::uint64_t second = 1; second < 10; ++second) {
    CHECK(bench.answers(kStray, second));
    bench.pass(950ms);
  }
  // The controller is answered from its first telegram on.
  for (std::uint64_t ipoc = 1000; ipoc < 9000; ipoc += 4) {
    bench.pass(4ms);
    const bool with_stray = ipoc % 1000 == 500;
    const auto replies = with_stray
                             ? bench.give({{kController, telegram(ipoc)}, {kStray, telegram(ipoc)}})
                             : bench.give({{kController, telegram(ipoc)}});
    if (replies != Replies{{kController, reply(ipoc)}}) FAIL(ipoc);
  }
  CHECK(bench.counts().foreign == 8);
}

TEST_CASE("a controller that no longer streams gives way to the next",
          "[server][issue11][point_8]") {
  BareServer bench;
  std::uint64_t ipoc = 1000;
  const auto stream = [&](const Endpoint& source) {
    for (int k = 0; k < 10; ++k, ipoc += 4) {
      bench.pass(4ms);
      bench.give({{source, telegram(ipoc)}});
    }
  };
  stream(kController);
  CHECK_FALSE(bench.answers(kStray, 4));
  SECTION("silent") {
    bench.pass(1100ms);
  }
  SECTION("speaking now and then") {
    for (int k = 0; k < 3; ++k) {
      bench.pass(900ms);
      CHECK(bench.answers(kController, ++ipoc));
    }
  }
  SECTION("forgotten") {
    bench.forget_controller();
  }
  CHECK(bench.answers(kStray, 8));
  stream(kStray);
  CHECK_FALSE(bench.answers(kController, 4));
}

TEST_CASE("a standstill of this program does not make the controller give way",
          "[server][issue11][point_8]") {
  BareServer bench;
  for (std::uint64_t ipoc = 1000; ipoc < 1040; ipoc += 4) CHECK(bench.answers(kController, ipoc));
  HandClock::time = HandClock::time.load() + 5s;  // nobody looked
  const auto replies = bench.give({{kStray, telegram(7)},
                                   {kController, telegram(1040)},
                                   {kController, telegram(1044)},
                                   {kStray, telegram(8)}});
  CHECK(replies == Replies{{kController, reply(1044)}});
}

TEST_CASE("what is heard is known until the last look that took all", "[server][issue13]") {
  BareServer bench;
  bench.pass(3s);
  const auto looked = HandClock::now();
  CHECK(bench.heard_until() == looked);
  HandClock::time = HandClock::time.load() + 5s;  // nobody looked
  CHECK(bench.heard_until() == looked);
  CHECK(bench.answers(kController, 1000));
  CHECK(bench.heard_until() == looked + 5s);
}

TEST_CASE("damaged telegrams between good ones do not make a controller give way",
          "[server][issue11][point_8]") {
  BareServer bench;
  for (std::uint64_t ipoc = 2000; ipoc < 6000; ipoc += 4) {
    bench.pass(4ms);
    if (!bench.answers(kController, ipoc) || !bench.answers(kController, 77)) FAIL(ipoc);
    if (ipoc >= 2012 && bench.answers(kStray, 8)) FAIL(ipoc);
  }
  for (std::uint64_t ipoc = 40; ipoc < 5000; ipoc += 4) {  // RSI begins anew
    bench.pass(4ms);
    if (!bench.answers(kController, ipoc) || bench.answers(kStray, 8)) FAIL(ipoc);
  }
}

TEST_CASE("what is handed over says whether its source streams, and which of it are replies",
          "[server][issue11][point_8]") {
  BareServer bench;
  for (std::uint64_t ipoc = 1000; ipoc < 1020; ipoc += 4) {
    bench.give({{kController, telegram(ipoc)}});
    Datagram datagram;
    rsi::Handling handling;
    REQUIRE(bench.datagrams().pop(datagram, &handling));
    CHECK_FALSE(handling.sent);
    CHECK(handling.streams == (ipoc >= 1012));
    REQUIRE(bench.datagrams().pop(datagram, &handling));
    CHECK(handling.sent);
    CHECK(datagram.destination == kController);
  }
}

TEST_CASE("a reply is wrapped if its telegram was", "[server][issue11][point_20]") {
  BareServer bench;
  const std::string wrapped =
      "<?xml version=\"1.0\"?>\r\n<Rob Type=\"KUKA\" "
      "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema\">"
      "\r\n\t<Dat TaskType=\"b\">\r\n\t<DiI>0</DiI><IPOC>8</IPOC>\r\n</Dat>\r\n</Rob>";
  CHECK(bench.give({{kController, wrapped}}) ==
        Replies{
            {kController, "<Sen Type=\"ImFree\"><Dat TaskType=\"b\"><IPOC>8</IPOC></Dat></Sen>"}});
  CHECK(bench.give({{kController, telegram(12)}}) == Replies{{kController, reply(12)}});
  CHECK(bench.counts().refused == 0);
}

TEST_CASE("junk of one that never sent an IPOC is a stranger's", "[server][issue11][point_8]") {
  BareServer bench;
  bench.give({{kStray, "junk"}, {kController, telegram(4)}, {kController, "junk"}});
  CHECK(bench.counts().foreign == 1);
  CHECK(bench.counts().unanswerable == 1);
}
