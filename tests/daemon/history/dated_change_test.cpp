#include "daemon/history/dated_change.hpp"

#include <cmath>
#include <random>

#include "tests/catch.hpp"

using sweepd::ChangeKind;
using sweepd::dated_changes;
using sweepd::NumberSeries;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// So many campaigns, one a month, of three numbers with noise of 1.
NumberSeries noise(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<> normal;
  NumberSeries series;
  for (std::size_t i = 0; i < count; ++i) {
    series.times.push_back(static_cast<double>(i) / 12);
    series.values.emplace_back(3);
    for (double& value : series.values.back()) value = 100 + normal(random);
    series.weights.push_back(Eigen::MatrixXd::Identity(3, 3));
  }
  return series;
}

}  // namespace

TEST_CASE("a jump is dated and named, and its size is told", "[dated_change]") {
  NumberSeries series = noise(60, 1);
  for (std::size_t i = 25; i < 60; ++i) series.values[i](1) += 5;
  const auto found = dated_changes(series, 0.05);
  REQUIRE(found.size() == 1);
  CHECK(found[0].kind == ChangeKind::jump);
  CHECK(found[0].number == 1);
  CHECK(found[0].at == 25);
  CHECK(found[0].earliest <= 25);
  CHECK(found[0].latest >= 25);
  CHECK(found[0].latest - found[0].earliest <= 2);
  CHECK(found[0].size == Approx(5).margin(3 * found[0].sigma));
  CHECK(found[0].sigma == Approx(std::sqrt(1 / 25.0 + 1 / 35.0)).epsilon(0.5));
}

TEST_CASE("a slow drift is no jump", "[dated_change]") {
  NumberSeries series = noise(80, 2);
  for (std::size_t i = 30; i < 80; ++i)
    series.values[i](2) += 2 * (series.times[i] - series.times[30]);
  const auto found = dated_changes(series, 0.05);
  REQUIRE(found.size() == 1);
  CHECK(found[0].kind == ChangeKind::drift);
  CHECK(found[0].number == 2);
  CHECK(found[0].size == Approx(2).margin(4 * found[0].sigma));
  CHECK(found[0].earliest <= 32);
  CHECK(found[0].latest >= 28);
}

TEST_CASE("a jump, a drift and one odd campaign are told apart", "[dated_change]") {
  NumberSeries series = noise(100, 3);
  for (std::size_t i = 0; i < 100; ++i) {
    if (i >= 40) series.values[i](0) += 6;
    series.values[i](2) -= 1.5 * series.times[i];
  }
  series.values[70](1) -= 12;
  const auto found = dated_changes(series, 0.05);
  REQUIRE(found.size() == 3);
  CHECK(found[0].kind == ChangeKind::drift);
  CHECK(found[0].size == Approx(-1.5).margin(0.2));
  CHECK(found[1].kind == ChangeKind::jump);
  CHECK(found[1].at == 40);
  CHECK(found[2].kind == ChangeKind::odd);
  CHECK(found[2].at == 70);
  CHECK(found[2].number == 1);
}

TEST_CASE("what campaigns do not tell is left out", "[dated_change]") {
  NumberSeries series = noise(40, 4);
  for (std::size_t i = 20; i < 40; ++i) series.values[i](1) += 6;
  for (std::size_t i = 0; i < 40; ++i) {
    const Eigen::Index gone = i % 3 == 0 ? 1 : 2;  // number 2 is told by a few alone
    series.values[i](gone) = kNone;
    series.weights[i](gone, gone) = 0;
    if (i % 3 != 0 || i > 30) continue;
    series.values[i](2) = kNone;
    series.weights[i](2, 2) = 0;
  }
  const auto found = dated_changes(series, 0.05);
  REQUIRE(found.size() == 1);
  CHECK(found[0].number == 1);
  CHECK(found[0].at >= 19);
  CHECK(found[0].at <= 22);
}

TEST_CASE("few unchanged series have a change", "[dated_change]") {
  int called = 0;
  constexpr int kSeries = 150;
  for (std::uint32_t seed = 0; seed < kSeries; ++seed)
    called += !dated_changes(noise(40, 100 + seed), 0.05).empty();
  CHECK(called <= 0.08 * kSeries);
}

TEST_CASE("a season that the weights do not know is hardly ever a change", "[dated_change]") {
  int called = 0;
  constexpr int kSeries = 40;
  for (std::uint32_t seed = 0; seed < kSeries; ++seed) {
    NumberSeries series = noise(96, 500 + seed);
    for (std::size_t i = 0; i < 96; ++i)
      series.values[i](0) += std::sin(2 * 3.14159265 * series.times[i]);
    called += !dated_changes(series, 0.05).empty();
  }
  CHECK(called <= 4);
}

TEST_CASE("too few campaigns have no dates", "[dated_change]") {
  CHECK(dated_changes(noise(2, 1), 0.05).empty());
  NumberSeries series = noise(3, 1);
  series.values[2](0) += 100;
  const auto found = dated_changes(series, 0.05);
  REQUIRE(found.size() == 1);
  CHECK(found[0].at == 2);
}
