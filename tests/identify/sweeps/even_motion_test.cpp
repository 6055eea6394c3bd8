#include "identify/sweeps/even_motion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;

namespace {

constexpr Eigen::Index kOfMotion = 600;

/// Gets to speed for a share of all samples, then goes on evenly, and stops as it began.
Eigen::ArrayXd motion(double ramp, double a_sample) {
  Eigen::ArrayXd places(kOfMotion);
  const double wide = ramp * static_cast<double>(kOfMotion);
  double place = 0;
  for (Eigen::Index i = 0; i < kOfMotion; ++i) {
    places(i) = place;
    const double ends = static_cast<double>(std::min(i, kOfMotion - 1 - i)) + 0.5;
    place += a_sample * (wide > 0 ? std::min(1.0, ends / wide) : 1);
  }
  return places;
}

}  // namespace

TEST_CASE("what numbers scatter by about an even motion is theirs, however it gets to speed",
          "[even_motion][issue12]") {
  const double ramp = GENERATE(0.0, 0.1, 0.3);
  const double noise = GENERATE(0.01, 1.0);
  CAPTURE(ramp, noise);
  test::Random random(3);
  double mean = 0;
  constexpr int kTimes = 20;
  for (int time = 0; time < kTimes; ++time) {
    Eigen::ArrayXd numbers = motion(ramp, 30);
    for (double& number : numbers) number += random.normal(noise);
    mean += unevenness(numbers) / kTimes;
  }
  CHECK(mean == Approx(noise * noise).epsilon(0.1));
}

TEST_CASE("numbers that take two values scatter as these do", "[even_motion][issue12]") {
  const double share = GENERATE(0.5, 0.3, 0.1);
  CAPTURE(share);
  test::Random random(5);
  Eigen::ArrayXd numbers(20 * kOfMotion);
  for (double& number : numbers) number = random.uniform(0, 1) < share ? 1 : 0;
  CHECK(unevenness(numbers) == Approx(share * (1 - share)).epsilon(0.1));
}

TEST_CASE("samples that are missing make no motion uneven", "[even_motion]") {
  test::Random random(7);
  const Eigen::ArrayXd places = motion(0.2, 30);
  std::vector<double> numbers;
  for (const double place : places)
    if (random.uniform(0, 1) > 0.02) numbers.push_back(place + random.normal(0.1));
  const Eigen::Map<const Eigen::ArrayXd> left(numbers.data(),
                                              static_cast<Eigen::Index>(numbers.size()));
  CHECK(unevenness(left) == Approx(0.01).epsilon(0.3));
  CHECK(unevenness(Eigen::ArrayXd::Zero(2)) == 0);
}

TEST_CASE("an even motion is seen better from many samples, at whatever times they were taken",
          "[even_motion]") {
  test::Random random(9);
  Eigen::ArrayXd times(kOfMotion), places(kOfMotion), seen(kOfMotion);
  double time = 100;
  for (Eigen::Index i = 0; i < kOfMotion; ++i) {
    times(i) = time;
    places(i) = 5 + 20 * time;
    seen(i) = places(i) + random.normal();
    time += random.uniform(0, 1) < 0.1 ? 0.012 : 0.004;
  }
  const EvenMotion even(times);
  const double off = std::sqrt((even(seen) - places).square().mean());
  CHECK(off == Approx(even.noise()).epsilon(0.15));
  CHECK(even.noise() == Approx(1.0 / 3));
  // Of a few, or at one time, nothing better is known.
  const EvenMotion few(times.head(8)), at_once(Eigen::ArrayXd::Constant(20, 3.0));
  CHECK((few(seen.head(8)) == seen.head(8)).all());
  CHECK(few.noise() == 1);
  CHECK(at_once(seen.head(20)).allFinite());
}
