#include "rsi/link/link_report.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include "tests/catch.hpp"

TEST_CASE("the ten worst are kept in order, of equals those that came first", "[link_report]") {
  std::mt19937 random(3);
  std::uniform_int_distribution<std::int64_t> amount(0, 20);  // many equals
  rsi::WorstPlaces worst;
  CHECK(worst.empty());
  std::vector<rsi::Place> all;
  for (std::uint64_t i = 0; i < 200; ++i) {
    all.push_back({{}, i, amount(random)});
    worst.add(all.back());
    auto sorted = all;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.amount > b.amount; });
    REQUIRE(worst.places().size() == std::min<std::size_t>(10, all.size()));
    for (std::size_t k = 0; k < worst.places().size(); ++k) {
      REQUIRE(worst.places()[k].amount == sorted[k].amount);
      REQUIRE(worst.places()[k].ipoc == sorted[k].ipoc);
    }
  }
}
