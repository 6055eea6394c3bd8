#include "identify/geometry/median.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/catch.hpp"

using identify::mean_of_most;
using identify::median_of;

namespace {

double by_sorting(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

TEST_CASE("A median is the middle one of the values in order", "[median]") {
  std::mt19937_64 random(17);
  std::normal_distribution<double> normal;
  for (std::size_t count = 1; count < 3000; count += 1 + count / 3) {
    CAPTURE(count);
    std::vector<double> values(count);
    for (double& value : values) value = std::abs(normal(random));
    CHECK(median_of(values) == by_sorting(values));
    for (double& value : values) value = std::floor(3 * value);  // many are equal
    CHECK(median_of(values) == by_sorting(values));
    std::sort(values.begin(), values.end());
    CHECK(median_of(values) == by_sorting(values));
    std::reverse(values.begin(), values.end());
    CHECK(median_of(values) == by_sorting(values));
    CHECK(median_of(std::vector<double>(count, 0.5)) == 0.5);
  }
  CHECK(median_of({}) == 0);
}

TEST_CASE("Whatever the values are, all of them stay and the median is found in time", "[median]") {
  // What is no number has no place in any order: nothing is promised but an end.
  std::vector<double> strange(1000, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < strange.size(); i += 3) strange[i] = static_cast<double>(i);
  (void)median_of(strange);
  // The nine values that a pivot is taken of are the least ones, again and again.
  std::vector<double> values(100'000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
  for (std::size_t eighth = 0; eighth <= 8; ++eighth)
    values[(values.size() - 1) * eighth / 8] = -static_cast<double>(eighth);
  const double middle = by_sorting(values);
  auto reordered = values;
  CHECK(identify::median_in(reordered) == middle);
  std::sort(values.begin(), values.end());
  std::sort(reordered.begin(), reordered.end());
  CHECK(values == reordered);
}

TEST_CASE("the mean of most values is that of two in turn, and not that of strays", "[median]") {
  std::vector<double> in_turn(25, 1.0), strays(100, 3.0);
  std::fill_n(in_turn.begin(), 11, 0.0);
  CHECK(mean_of_most(in_turn) == Approx(14.0 / 25));
  for (std::size_t i = 0; i < strays.size(); ++i) strays[i] += i % 2 == 0 ? 0.1 : -0.1;
  std::fill_n(strays.begin() + 40, 10, 1000.0);
  CHECK(mean_of_most(strays) == Approx(3));
  std::vector<double> none;
  CHECK(mean_of_most(none) == 0);
}
