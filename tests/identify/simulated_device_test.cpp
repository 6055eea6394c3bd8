#include <cmath>

#include "tests/catch.hpp"
#include "tests/identify/simulated_robots.hpp"
#include "tests/simulation/device.hpp"

using namespace simulation;
using namespace simulation::robots;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using Eigen::Vector3d;

TEST_CASE("White and correlated noise are as large and as much alike as they should be",
          "[simulated_device]") {
  for (const double correlation : {0.0, 0.9}) {
    Noise noise;
    noise.range_mm = noise.across_mm = 0.02;
    noise.correlation = correlation;
    Device device(noise, {}, 1, 7);
    Spread all;
    double products = 0;
    Vector3d before = Vector3d::Zero();
    constexpr int kCount = 100'000;
    for (int i = 0; i < kCount; ++i) {
      const Vector3d error = device.measured(Vector3d::Zero(), 0);
      for (const double one : error) all.add(one);
      products += error.dot(before);
      before = error;
    }
    CHECK_THAT(all.sigma(), WithinRel(0.02, 0.02));
    CHECK_THAT(products / all.squares, WithinAbs(correlation, 0.01));
  }
}

TEST_CASE("A tracker's noise lies along and across its line of sight", "[simulated_device]") {
  Noise noise;
  noise.range_mm = 0.005;
  noise.across_mm = 0.03;
  const Vector3d point(1000, -2000, 500);
  const Vector3d sight = point.normalized();
  Device device(noise, {}, 1, 8);
  Spread along, across;
  for (int i = 0; i < 20'000; ++i) {
    const Vector3d error = device.measured(point, 0) - point;
    along.add(sight.dot(error));
    across.add(sight.unitOrthogonal().dot(error));
  }
  CHECK_THAT(along.sigma(), WithinRel(0.005, along.tolerance()));
  CHECK_THAT(across.sigma(), WithinRel(0.03, across.tolerance()));
}

TEST_CASE("Outliers are as many and as far off as asked for", "[simulated_device]") {
  Noise noise;
  noise.outlier_share = 0.15;
  Device device(noise, {}, 1, 9);
  int count = 0;
  for (int i = 0; i < 10'000; ++i) {
    const double off = device.measured(Vector3d::Zero(), 0).norm();
    if (off == 0) continue;
    CHECK_THAT(off, WithinAbs(5, 1e-9));
    ++count;
  }
  CHECK(std::abs(count - 1500) < 5 * 36);
}

TEST_CASE("A device drifts by what is asked for over the campaign", "[simulated_device]") {
  Device straight({}, {0.05, 0}, 100, 1);
  CHECK(straight.measured(Vector3d::Zero(), 0).isZero(0));
  CHECK_THAT(straight.measured(Vector3d::Zero(), 50).norm(), WithinAbs(0.025, 1e-12));
  CHECK_THAT(straight.measured(Vector3d::Zero(), 100).norm(), WithinAbs(0.05, 1e-12));
  Spread ends;
  for (std::uint32_t seed = 0; seed < 1000; ++seed) {
    Device walking({}, {0, 0.05}, 100, seed);
    Vector3d end;
    for (int i = 0; i <= 10; ++i) end = walking.measured(Vector3d::Zero(), 10 * i);
    for (const double one : end) ends.add(one);
  }
  CHECK_THAT(ends.sigma(), WithinRel(0.05 / std::sqrt(3.0), ends.tolerance()));
}
