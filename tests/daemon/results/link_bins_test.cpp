#include "daemon/results/link_bins.hpp"

#include <random>

#include "tests/catch.hpp"

using namespace std::chrono_literals;
using sweepd::link_bins;

TEST_CASE("bins end at 1, 2 and 5 times a power of ten, from the first used to the last",
          "[link_bins]") {
  rsi::LatencyHistogram histogram;
  CHECK(link_bins(histogram).empty());
  for (const auto duration : {12us, 19us, 30us, 150us}) histogram.add(duration);
  const auto bins = link_bins(histogram);
  REQUIRE(bins.size() == 4);
  CHECK((bins[0].from == 10us && bins[0].to == 20us && bins[0].count == 2));
  CHECK((bins[1].from == 20us && bins[1].to == 50us && bins[1].count == 1));
  CHECK((bins[2].from == 50us && bins[2].to == 100us && bins[2].count == 0));
  CHECK((bins[3].from == 100us && bins[3].to == 200us && bins[3].count == 1));
}

TEST_CASE("nothing is left out of the bins, from zero to the longest duration there is",
          "[link_bins]") {
  rsi::LatencyHistogram histogram;
  histogram.add(0ns);
  histogram.add(std::chrono::nanoseconds::max());
  auto bins = link_bins(histogram);
  CHECK(bins.front().from == 0ns);
  CHECK(bins.front().to == 1us);
  CHECK(bins.back().count == 1);
  std::mt19937_64 random(5);
  for (int i = 0; i < 1000; ++i)
    histogram.add(std::chrono::nanoseconds(static_cast<std::int64_t>(random() >> (1 + i % 62))));
  std::uint64_t sum = 0;
  for (const auto& bin : link_bins(histogram)) sum += bin.count;
  CHECK(sum == 1002);
}
