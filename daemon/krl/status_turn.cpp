#include "daemon/krl/status_turn.hpp"

#include <cmath>

#include "identify/geometry/angle.hpp"

namespace sweepd {

using identify::kDegree;
using identify::kPi;

constexpr double kNoTurn_rad = 2 * kDegree;

identify::Posture posture_of(unsigned status) {
  return {(status & 1U) != 0, (status & 2U) != 0, (status & 4U) != 0};
}

unsigned turn_of(const std::array<double, 6>& angles_rad) {
  unsigned turn = 0;
  for (std::size_t j = 0; j < 6; ++j)
    if (angles_rad[j] < 0) turn |= 1U << j;
  return turn;
}

std::array<double, 6> turned_as(std::array<double, 6> angles_rad, unsigned turn) {
  for (std::size_t j = 0; j < 6; ++j) {
    double& angle = angles_rad[j];
    const bool negative = (turn >> j & 1U) != 0;
    if (negative == (angle < 0) || std::abs(angle) < kNoTurn_rad) continue;
    angle += negative ? -2 * kPi : 2 * kPi;
  }
  return angles_rad;
}

}  // namespace sweepd
