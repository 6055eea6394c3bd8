#include "identify/clock/clock_rates.hpp"

#include "tests/catch.hpp"
#include "tests/identify/clock/motions.hpp"

using Catch::Matchers::WithinAbs;
using identify::match_clocks;
using identify::match_wrong_rate;
using identify::Motion;
using identify::test::by_chance;
using identify::test::by_other_clock;

TEST_CASE("Times of a wrong frame rate match at the rate that the motions have", "[clock_rates]") {
  const Motion controller = by_chance(1, 120);
  for (const double rate : {1e-3, -1e-3, 1 / 1001.0, 5e-4, -2.7e-3})
    for (const double ahead_s : {0.0, 1.7e9}) {
      const Motion device = by_other_clock(controller, ahead_s, rate, 0.005);
      CAPTURE(rate, ahead_s);
      CHECK(match_clocks(device, controller).matches.empty());
      const auto found = match_wrong_rate(device, controller);
      REQUIRE(found.matches.size() == 1);
      const auto& match = found.matches.front();
      CHECK(match.matched == 120);
      CHECK_THAT(match.rate, WithinAbs(rate, 1e-5));
      for (const double at_s : {10.0, 500.0})
        CHECK_THAT(match.controller_s(at_s + ahead_s + rate * at_s), WithinAbs(at_s, 0.003));
    }
}

TEST_CASE("No rate is found where the motions are others", "[clock_rates]") {
  for (std::uint32_t seed = 10; seed < 40; ++seed)
    CHECK(match_wrong_rate(by_chance(seed), by_chance(seed + 1000)).matches.empty());
  CHECK(match_wrong_rate({}, by_chance(1)).matches.empty());
  CHECK(match_wrong_rate(by_chance(1), {}).matches.empty());
}
