#include "daemon/system/heartbeat.hpp"

#include <algorithm>

#include "tests/catch.hpp"

using sweepd::Heartbeat;
using namespace std::chrono_literals;

namespace {

const Heartbeat::Time kFirstBeat{1h};

}  // namespace

TEST_CASE("as long as every thread moves, nothing stands still", "[heartbeat]") {
  Heartbeat heartbeat(3s);
  for (std::uint64_t second = 0; second < 100; ++second)
    CHECK(heartbeat
              .look({{"a", 10 * second, second}, {"b", second, 10 * second}},
                    kFirstBeat + std::chrono::seconds(second))
              .empty());
}

TEST_CASE("a thread that does not move for longer than the patience is named, and since when",
          "[heartbeat]") {
  Heartbeat heartbeat(3s);
  // Robot b's acquisition last moves in second 2, its reply thread in second 4.
  for (std::uint64_t second = 0; second <= 8; ++second) {
    const auto still = heartbeat.look(
        {{"a", second, second},
         {"b", std::min<std::uint64_t>(second, 4), std::min<std::uint64_t>(second, 2)}},
        kFirstBeat + std::chrono::seconds(second));
    INFO(second);
    REQUIRE(still.size() == (second <= 5 ? 0 : second <= 7 ? 1 : 2));
    if (still.empty()) continue;
    CHECK(still.back().robot == "b");
    CHECK(still.back().thread == "acquisition");
    CHECK(still.back().since == kFirstBeat + 2s);
    if (still.size() == 1) continue;
    CHECK(still.front().thread == "reply");
    CHECK(sweepd::text(still.front(), kFirstBeat + 8500ms) ==
          "b: the reply thread has stood still for 4 s");
  }
  SECTION("until it moves again") {
    CHECK(heartbeat.look({{"a", 9, 9}, {"b", 5, 3}}, kFirstBeat + 9s).empty());
  }
}

TEST_CASE("a robot that is new gets its time to start, one that went is forgotten", "[heartbeat]") {
  Heartbeat heartbeat(3s);
  CHECK(heartbeat.look({{"a", 0, 0}}, kFirstBeat).empty());
  CHECK(heartbeat.look({{"a", 1, 1}}, kFirstBeat + 2s).empty());
  CHECK(heartbeat.look({{"b", 0, 0}}, kFirstBeat + 4s).empty());
  CHECK(heartbeat.look({{"a", 1, 1}, {"b", 0, 0}}, kFirstBeat + 6s).empty());
  const auto still = heartbeat.look({{"a", 1, 1}, {"b", 1, 0}}, kFirstBeat + 8s);
  REQUIRE(still.size() == 1);
  CHECK(still[0].robot == "b");
  CHECK(still[0].thread == "acquisition");
}

TEST_CASE("after a pause in which nobody looked, the machine's own for one, patience begins anew",
          "[heartbeat]") {
  Heartbeat heartbeat(3s);
  CHECK(heartbeat.look({{"a", 1, 1}}, kFirstBeat).empty());
  CHECK(heartbeat.look({{"a", 1, 1}}, kFirstBeat + 60s).empty());
  CHECK(heartbeat.look({{"a", 1, 1}}, kFirstBeat + 62s).empty());
  CHECK(heartbeat.look({{"a", 1, 1}}, kFirstBeat + 64s).size() == 2);
}
