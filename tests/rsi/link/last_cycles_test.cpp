#include "rsi/link/last_cycles.hpp"

#include <algorithm>

#include "tests/catch.hpp"
#include "tests/rsi/link_stream.hpp"

using Catch::Matchers::ContainsSubstring;
using rsi::LastCycles;
using namespace rsi::test;

namespace {

constexpr const char* kFlightHeader =
    "received_s,replied_s,ipoc,latency_us,delay_packets,lost_before_packets,event\n";

struct Flight {
  explicit Flight(bool replies = true) : expects_replies(replies) {}
  [[nodiscard]] LastCycles last() const { return {link, expects_replies, withheld}; }
  [[nodiscard]] std::string csv() const { return last().csv(); }
  [[nodiscard]] std::string reason() const { return last().reason(); }
  [[nodiscard]] bool ended_badly() const { return !reason().empty(); }

  bool expects_replies;
  std::uint64_t withheld = 0;
  rsi::Link link;
  LinkStream<rsi::Link> stream{link};
};

/// How many rows end in this event.
long rows(const Flight& flight, const std::string& event) {
  const std::string csv = flight.csv();
  const std::string end = "," + event + "\n";
  long count = 0;
  for (auto at = csv.find(end); at != csv.npos; at = csv.find(end, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("nothing recorded is a header, and ended well", "[last_cycles]") {
  CHECK(Flight().csv() == kFlightHeader);
  CHECK_FALSE(Flight().ended_badly());
}

TEST_CASE("each cycle is a row with times to the nanosecond", "[last_cycles]") {
  Flight flight;
  flight.stream.telegram(0ms, 1000, 0);
  flight.stream.reply(50'120ns, 1000);
  flight.stream.telegram(4'000'007ns, 1004, {});
  flight.stream.reply(4'031'007ns, 1004);
  CHECK(flight.csv() == std::string(kFlightHeader) +
                            "1735689600.000000000,1735689600.000050120,1000,50.120,0,0,answered\n"
                            "1735689600.004000007,1735689600.004031007,1004,31.000,,0,answered\n");
  CHECK_FALSE(flight.ended_badly());
}

TEST_CASE("the last 256 cycles are kept, the oldest first; what was before is forgiven",
          "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 100, 9ms);
  CHECK(flight.ended_badly());
  flight.stream.cycles(100, 400);
  CHECK_FALSE(flight.ended_badly());
  const auto csv = flight.csv();
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 257);
  CHECK(rows(flight, "answered") == 256);
  CHECK(csv.find(",1000576,") < csv.find(",1001596,"));  // numbers 144 and 399
  CHECK_THAT(csv, !ContainsSubstring(",1000572,"));
}

TEST_CASE("a late reply is a bad end", "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 20);
  flight.stream.cycles(20, 22, 4001us);
  flight.stream.cycles(22, 30);
  CHECK(rows(flight, "late") == 2);
  CHECK(flight.reason() ==
        "in the last 30 cycles 2 replies left later than a cycle: see what kept this machine busy");
}

TEST_CASE("a missing reply is a bad end; those just passed over are told from the others",
          "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 20);
  for (std::uint64_t k = 20; k < 25; ++k)
    flight.stream.telegram(flight.stream.at(k), flight.stream.ipoc(k));
  flight.stream.reply(flight.stream.at(24) + 1ms, flight.stream.ipoc(24));
  CHECK(rows(flight, "unanswered") == 3);
  CHECK(rows(flight, "superseded") == 1);
  CHECK_THAT(flight.reason(), ContainsSubstring("4 telegrams got no reply"));
}

TEST_CASE("the last telegram may be awaiting its reply, those before it are missing theirs",
          "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 20);
  flight.stream.telegram(flight.stream.at(20), flight.stream.ipoc(20));
  CHECK_FALSE(flight.ended_badly());
  CHECK(rows(flight, "received") == 1);
  flight.stream.telegram(flight.stream.at(21), flight.stream.ipoc(21));
  CHECK(rows(flight, "unanswered") == 1);
  CHECK(flight.ended_badly());
}

TEST_CASE("a reply that could not be sent is said before all else", "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 20);
  flight.stream.telegram(flight.stream.at(20), flight.stream.ipoc(20));
  flight.stream.reply_datagram(flight.stream.at(20) + 1us, "");
  flight.stream.cycles(21, 30, 4500us);
  CHECK(rows(flight, "send_failed") == 1);
  CHECK_THAT(flight.reason(), ContainsSubstring("1 reply could not be sent"));
  Flight().stream.reply_datagram(0ms, "");  // before any telegram: no cycle to mark
}

TEST_CASE("Delay of a controller that was answered in time points at the network",
          "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 20);
  flight.stream.telegram(flight.stream.at(20), flight.stream.ipoc(20), 3);
  flight.stream.reply(flight.stream.at(20) + 1us, flight.stream.ipoc(20));
  CHECK_THAT(flight.reason(),
             ContainsSubstring("3 replies in a row") && ContainsSubstring("look at the network"));
}

TEST_CASE("lost telegrams are a bad end, latecomers and duplicates are not", "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 20);
  flight.stream.cycles(21, 22);
  flight.stream.telegram(85ms, flight.stream.ipoc(20));
  flight.stream.reply(85ms + 1us, flight.stream.ipoc(20));
  flight.stream.telegram(86ms, flight.stream.ipoc(20));
  flight.stream.reply(86ms + 1us, flight.stream.ipoc(20));
  flight.stream.cycles(22, 30);
  CHECK_FALSE(flight.ended_badly());
  CHECK(rows(flight, "duplicate") == 1);
  CHECK(rows(flight, "answered") == 30);
  flight.stream.cycles(32, 40);
  CHECK_THAT(flight.reason(), ContainsSubstring("2 telegrams never came"));
  CHECK_THAT(flight.csv(), ContainsSubstring(",1000128,50.000,0,2,answered\n"));
}

TEST_CASE("what is no telegram has a row and is a bad end", "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 20);
  flight.stream.datagram(79ms, "binary \xff");
  flight.stream.cycles(20, 30);
  CHECK_THAT(flight.csv(), ContainsSubstring("1735689600.079000000,,,,,0,malformed\n"));
  CHECK_THAT(flight.reason(), ContainsSubstring("1 datagram was no whole telegram"));
}

TEST_CASE("telegrams that were not answered on purpose are no bad end", "[last_cycles]") {
  Flight flight;
  for (std::uint64_t k = 0; k < 250; ++k)
    flight.stream.telegram(flight.stream.at(k), flight.stream.ipoc(k));
  flight.stream.cycles(250, 350);
  flight.withheld = 250;
  CHECK_FALSE(flight.ended_badly());
  CHECK(rows(flight, "withheld") == 156);  // 94 were before the last 256
  CHECK(rows(flight, "answered") == 100);
  flight.withheld = 200;
  CHECK(flight.ended_badly());
  CHECK(rows(flight, "unanswered") == 49);
  CHECK(rows(flight, "superseded") == 1);  // by the first that was answered
}

TEST_CASE("a controller with ONLYSEND ends badly only by what got lost", "[last_cycles]") {
  Flight flight(false);
  for (std::uint64_t k = 0; k < 30; ++k)
    flight.stream.telegram(flight.stream.at(k), flight.stream.ipoc(k), k % 3);
  CHECK_FALSE(flight.ended_badly());
  CHECK(rows(flight, "received") == 30);
  flight.stream.telegram(flight.stream.at(33), flight.stream.ipoc(33));
  CHECK_THAT(flight.reason(), ContainsSubstring("3 telegrams never came"));
}

TEST_CASE("a simulator whose IPOC rises by one has its cycle by the clock", "[last_cycles]") {
  Flight flight;
  for (std::uint64_t k = 0; k < 30; ++k) {
    flight.stream.telegram(flight.stream.at(k), k);
    flight.stream.reply(flight.stream.at(k) + 3ms, k);
  }
  CHECK_FALSE(flight.ended_badly());
  flight.stream.telegram(flight.stream.at(30), 30);
  flight.stream.reply(flight.stream.at(30) + 5ms, 30);
  CHECK(rows(flight, "late") == 1);
}

TEST_CASE("RSI that begins anew is no loss", "[last_cycles]") {
  Flight flight;
  flight.stream.cycles(0, 20);
  flight.stream.controller.port = 50001;
  flight.stream.cycles(100'000, 100'020);
  CHECK_FALSE(flight.ended_badly());
}
