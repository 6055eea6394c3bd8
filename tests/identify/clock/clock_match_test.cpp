#include "identify/clock/clock_match.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "tests/catch.hpp"
#include "tests/identify/clock/motions.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;
using identify::Motion;
using identify::Span;
using identify::test::by_chance;
using identify::test::by_other_clock;

TEST_CASE("Clocks match by the motions that both saw, whatever their difference", "[clock_match]") {
  const Motion controller = by_chance(1);
  for (const double ahead_s : {0.0, 0.3, -7200.0, 1.7e9}) {
    const auto found = match_clocks(by_other_clock(controller, ahead_s, 5e-5, 0.005), controller);
    INFO(found.problem);
    REQUIRE(found.matches.size() == 1);
    const auto& match = found.matches.front();
    CHECK(match.matched == 30);
    CHECK(match.strange == 0);
    CHECK_THAT(match.ahead_s + match.rate * (50 - match.at_s),
               WithinAbs(ahead_s + 5e-5 * 50, 4 * 0.005 / std::sqrt(60.0)));
    CHECK_THAT(match.controller_s(ahead_s + 50 + 5e-5 * 50), WithinAbs(50, 0.003));
  }
}

TEST_CASE("Motions that the device missed, or a take that ends early, do not matter",
          "[clock_match]") {
  const Motion controller = by_chance(2);
  Motion device = by_other_clock(controller, 12, 0, 0.005);
  device.moves.erase(device.moves.begin() + 4);
  device.moves.resize(15);
  device.seen = {{device.moves.front().begin_s - 1, device.moves.back().end_s + 0.2}};
  const auto found = match_clocks(device, controller);
  INFO(found.problem);
  REQUIRE(found.matches.size() == 1);
  CHECK(found.matches.front().matched == 15);
  CHECK(found.matches.front().strange == 1);
  CHECK_THAT(found.matches.front().ahead_s, WithinAbs(12, 0.01));
}

TEST_CASE("A trace of another day is refused", "[clock_match]") {
  for (std::uint32_t seed = 10; seed < 40; ++seed) {
    const auto found = match_clocks(by_chance(seed), by_chance(seed + 1000));
    CHECK(found.matches.empty());
    CHECK_THAT(found.problem, ContainsSubstring("do not agree"));
  }
}

TEST_CASE("Motions that are all alike match in several ways", "[clock_match]") {
  Motion controller;
  for (int i = 0; i < 12; ++i) controller.moves.push_back({10.0 * i + 1, 10.0 * i + 6});
  controller.seen = {{0, 120}};
  Motion device = controller;
  device.seen = {{0.5, 117}};
  const auto found = match_clocks(device, controller);
  CHECK(found.matches.size() > 1);
}

TEST_CASE("A clock that was set midway is refused, with the time of it", "[clock_match]") {
  const Motion controller = by_chance(3);
  for (const double by_s : {0.04, -0.1, 2.0, 100.0}) {
    Motion device = by_other_clock(controller, 1, 0, 0.003);
    for (std::size_t i = 15; i < device.moves.size(); ++i) {
      device.moves[i].begin_s += by_s;
      device.moves[i].end_s += by_s;
    }
    device.seen = {{-100, 500}};
    const auto found = match_clocks(device, controller);
    INFO(by_s << " " << found.problem);
    CHECK(found.matches.empty());
    CHECK_THAT(found.problem, ContainsSubstring("offset of the clocks changes"));
  }
}

TEST_CASE("A clock that was set near an end of the take is refused, too", "[clock_match]") {
  const Motion controller = by_chance(3);
  for (const std::size_t before : {3U, 8U, 15U, 22U, 28U})
    for (const double by_s : {300.0, 3600.0}) {
      Motion device = by_other_clock(controller, 1, 0, 0);
      const double at_s = device.moves[before].begin_s - 0.15;
      device.seen = {{1, at_s - 0.01}, {at_s + by_s, device.seen.front().end_s + by_s}};
      for (std::size_t i = before; i < device.moves.size(); ++i) {
        device.moves[i].begin_s += by_s;
        device.moves[i].end_s += by_s;
      }
      const auto found = match_clocks(device, controller);
      INFO(before << " " << by_s << " " << found.problem);
      CHECK(found.matches.empty());
      CHECK_THAT(found.problem, ContainsSubstring("offset of the clocks changes by " +
                                                  std::to_string(static_cast<int>(by_s)) + "."));
    }
}

TEST_CASE("What each saw while the other had not begun, or had ended, is no clock that was set",
          "[clock_match]") {
  const Motion all = by_chance(4);
  Motion controller = all, device = by_other_clock(all, 7, 0, 0.003);
  controller.moves.resize(20);
  controller.seen = {{0, controller.moves.back().end_s + 0.3}};
  device.moves.erase(device.moves.begin(), device.moves.begin() + 10);
  device.seen.front().begin_s = device.moves.front().begin_s - 0.3;
  const auto found = match_clocks(device, controller);
  INFO(found.problem);
  REQUIRE(found.matches.size() == 1);
  CHECK(found.matches.front().matched == 10);
  // The device was blind meanwhile, and what it saw later is something else.
  const auto blind = std::pair(device.moves[6].begin_s - 0.2, device.moves[9].end_s + 0.2);
  device.moves.erase(device.moves.begin() + 6, device.moves.begin() + 10);
  device.seen = {{device.seen.front().begin_s, blind.first},
                 {blind.second, device.seen.front().end_s}};
  const auto later = match_clocks(device, controller);
  INFO(later.problem);
  CHECK(later.matches.size() == 1);
}

TEST_CASE("Too few motions are refused, saying whose", "[clock_match]") {
  CHECK_THAT(match_clocks(by_chance(1, 3), by_chance(1)).problem,
             ContainsSubstring("the device's points show 3 motions"));
  CHECK_THAT(match_clocks(by_chance(1), Motion{}).problem,
             ContainsSubstring("the angles of the trace show 0 motions"));
}
