#include "identify/geometry/sines.hpp"

#include <cmath>
#include <random>

#include "tests/catch.hpp"

TEST_CASE("Sines of angles that go on slowly, or jump, are those of the library", "[sines]") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> step(-0.03, 0.03), jump(-7, 7);
  identify::Sines sines;
  double angle = 0;
  for (int i = 0; i < 100'000; ++i) {
    angle = i % 1000 == 0 ? jump(random) : angle + step(random);
    sines.set(angle);
    // Of a double near one the last bit is 1.1e-16 or 2.2e-16.
    REQUIRE(std::abs(sines.sine - std::sin(angle)) <= 2.3e-16);
    REQUIRE(std::abs(sines.cosine - std::cos(angle)) <= 2.3e-16);
  }
}
