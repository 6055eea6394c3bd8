#include "identify/sweeps/window.hpp"

#include <algorithm>
#include <deque>
#include <random>

#include "tests/catch.hpp"

TEST_CASE("A window holds what a deque would", "[window]") {
  std::mt19937 random(5);
  identify::Window<int> window;
  std::deque<int> expected;
  for (int step = 0; step < 20'000; ++step) {
    const auto chance = random() % 1000;
    if (chance == 0) {
      window.clear();
      expected.clear();
    } else if (chance < 480 && !expected.empty()) {
      window.drop();
      expected.pop_front();
    } else {
      window.push_back(step);
      expected.push_back(step);
    }
    REQUIRE(window.empty() == expected.empty());
    REQUIRE(window.size() == expected.size());
    REQUIRE(std::equal(window.begin(), window.end(), expected.begin(), expected.end()));
    if (expected.empty()) continue;
    REQUIRE(window.front() == expected.front());
    REQUIRE(window.back() == expected.back());
    REQUIRE(window[expected.size() / 2] == expected[expected.size() / 2]);
  }
}
