#include "rsi/link/latency_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/catch.hpp"

using std::chrono::nanoseconds;

TEST_CASE("an empty histogram answers zero", "[latency_histogram]") {
  const rsi::LatencyHistogram histogram;
  CHECK(histogram.count() == 0);
  CHECK(histogram.max() == nanoseconds(0));
  CHECK(histogram.quantile(0.5) == nanoseconds(0));
}

TEST_CASE("durations below 128 ns are counted exactly", "[latency_histogram]") {
  rsi::LatencyHistogram histogram;
  for (int i = 1; i <= 100; ++i) histogram.add(nanoseconds(i));
  CHECK(histogram.quantile(0.0) == nanoseconds(1));
  CHECK(histogram.quantile(0.5) == nanoseconds(50));
  CHECK(histogram.quantile(0.99) == nanoseconds(99));
  CHECK(histogram.quantile(1.0) == nanoseconds(100));
}

TEST_CASE("a quantile is within one per cent of the sorted durations' from 1 ns to 20 minutes",
          "[latency_histogram]") {
  rsi::LatencyHistogram histogram;
  std::mt19937_64 random(7);
  std::vector<double> durations;
  for (int i = 0; i < 20001; ++i) {
    // Even over the logarithm, so that every octave is tried.
    const double share = static_cast<double>(random() >> 11) * 0x1p-53;
    const auto duration = std::floor(std::exp(share * std::log(1.2e12)));
    durations.push_back(duration);
    histogram.add(nanoseconds(static_cast<std::int64_t>(duration)));
  }
  std::sort(durations.begin(), durations.end());
  for (const double q : {0.001, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(q * 20001.0));
    const double exact = durations[rank - 1];
    const auto found = static_cast<double>(histogram.quantile(q).count());
    CAPTURE(q, exact, found);
    CHECK(std::abs(found - exact) <= 0.01 * exact);
  }
}

TEST_CASE("the largest duration is exact and no quantile exceeds it", "[latency_histogram]") {
  rsi::LatencyHistogram histogram;
  histogram.add(nanoseconds(1'000'001));
  histogram.add(nanoseconds(1'000'000));
  CHECK(histogram.max() == nanoseconds(1'000'001));
  CHECK(histogram.quantile(0.5) <= nanoseconds(1'000'001));
  CHECK(histogram.quantile(0.9) == nanoseconds(1'000'001));
}

TEST_CASE("a negative duration counts as zero and the longest one has a bucket",
          "[latency_histogram]") {
  rsi::LatencyHistogram histogram;
  histogram.add(nanoseconds(-5));
  CHECK(histogram.quantile(1.0) == nanoseconds(0));
  const nanoseconds longest(std::numeric_limits<std::int64_t>::max());
  histogram.add(longest);
  CHECK(histogram.count() == 2);
  CHECK(histogram.max() == longest);
  CHECK(histogram.quantile(0.5) == nanoseconds(0));
}

TEST_CASE("durations up to a limit are counted, those in its own bucket among them",
          "[latency_histogram]") {
  rsi::LatencyHistogram histogram;
  for (int i = 1; i <= 100; ++i) histogram.add(nanoseconds(i));
  histogram.add(nanoseconds(1'000'000));
  CHECK(histogram.at_most(nanoseconds(-1)) == 0);
  CHECK(histogram.at_most(nanoseconds(0)) == 0);
  CHECK(histogram.at_most(nanoseconds(40)) == 40);
  CHECK(histogram.at_most(nanoseconds(900'000)) == 100);
  CHECK(histogram.at_most(nanoseconds(1'000'000)) == 101);
  CHECK(histogram.at_most(nanoseconds::max()) == 101);
  SECTION("for many limits at once") {
    const std::vector<nanoseconds> limits{nanoseconds(-1), nanoseconds(40), nanoseconds(40),
                                          nanoseconds(900'000), nanoseconds::max()};
    CHECK(histogram.at_most(limits) == std::vector<std::uint64_t>{0, 40, 40, 100, 101});
    CHECK(histogram.at_most(std::vector<nanoseconds>{}).empty());
  }
}

TEST_CASE("the sum of all durations is exact", "[latency_histogram]") {
  rsi::LatencyHistogram histogram;
  CHECK(histogram.sum() == nanoseconds(0));
  for (int i = 1; i <= 1000; ++i) histogram.add(nanoseconds(1'000'001 * i));
  histogram.add(nanoseconds(-5));
  CHECK(histogram.sum() == nanoseconds(1'000'001LL * 500'500));
  histogram.add(nanoseconds::max());
  CHECK(histogram.sum() == nanoseconds::max());
}
