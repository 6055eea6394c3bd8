#include "daemon/krl/krl_position.hpp"

#include <cmath>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/robot.hpp"

using namespace sweepd;
using identify::kDegree;

TEST_CASE("T has a bit for each negative angle, and brings whole turns back", "[krl_position]") {
  CHECK(turn_of({0.1, -0.1, 0, 0.1, -0.2, -1}) == 50);
  const std::array<double, 6> told = {190 * kDegree,  -90 * kDegree, 90 * kDegree,
                                      -200 * kDegree, 30 * kDegree,  340 * kDegree};
  auto angles = told;
  for (double& angle : angles) angle = std::remainder(angle, 2 * identify::kPi);
  const auto back = turned_as(angles, turn_of(told));
  for (std::size_t j = 0; j < 6; ++j) CHECK(back[j] == Approx(told[j]).margin(1e-12));
  // An angle that is zero but for printing does not turn round.
  CHECK(turned_as({-1e-9, 0, 0, 0, 0, 0}, 0)[0] == -1e-9);
}

// S and T of points that real robots have printed: S 6, T 50; S 2, T 35; S 6, T 27. Bit 2 of S is
// set where bit 4 of T is.
TEST_CASE("S tells the posture", "[krl_position]") {
  CHECK(posture_of(6) == identify::Posture{false, true, true});
  CHECK(posture_of(2) == identify::Posture{false, true, false});
  CHECK(posture_of(1) == identify::Posture{true, false, false});
}
