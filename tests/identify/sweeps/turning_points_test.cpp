#include "identify/sweeps/turning_points.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"

using namespace identify;

namespace {

/// A hundred samples a stroke, through these angles, with so much noise.
std::vector<Sample> along(const std::vector<double>& corners_deg, double noise_mm) {
  std::mt19937 random(3);
  std::normal_distribution<> normal(0, noise_mm);
  std::vector<Sample> samples;
  for (std::size_t k = 1; k < corners_deg.size(); ++k)
    for (int i = 0; i < 100; ++i) {
      const double turn =
          kDegree * (corners_deg[k - 1] + (corners_deg[k] - corners_deg[k - 1]) * i / 100);
      Sample sample;
      sample.position_mm = {400 * std::cos(turn) + normal(random),
                            400 * std::sin(turn) + normal(random), 70 + normal(random)};
      sample.has_position = true;
      samples.push_back(sample);
    }
  return samples;
}

}  // namespace

TEST_CASE("Each turn of the motion is found, where it is and no other", "[turning_points]") {
  for (const double noise_mm : {0.0, 0.02, 1.0}) {
    CAPTURE(noise_mm);
    CHECK(turning_points(along({0, 60}, noise_mm)).empty());
    const auto found = turning_points(along({-50, 40, -50, 10}, noise_mm));
    REQUIRE(found.size() == 2);
    CHECK(std::abs(static_cast<int>(found[0]) - 100) < 8);
    CHECK(std::abs(static_cast<int>(found[1]) - 200) < 8);
  }
  // A sway of a degree is none; half of a circle each way is two strokes.
  CHECK(turning_points(along({0, 30, 29, 60}, 0.02)).empty());
  CHECK(turning_points(along({-90, 90, -90}, 0.02)).size() == 1);
}

TEST_CASE("Points in no order, and on no circle, have no turns", "[turning_points]") {
  auto samples = along({0, 90}, 0.02);
  std::shuffle(samples.begin(), samples.end(), std::mt19937(5));
  CHECK(turning_points(samples).empty());
  for (Sample& sample : samples) sample.position_mm = {1, 2, 3};
  CHECK(turning_points(samples).empty());
  CHECK(turning_points({}).empty());
}
