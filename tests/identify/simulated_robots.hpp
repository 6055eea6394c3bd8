#pragma once

// What the tests of the simulation share.

#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "tests/simulation/simulation.hpp"

namespace simulation::robots {

using identify::kArcsec;
using identify::kDegree;
using identify::kPi;

inline Robot robot(std::uint32_t seed = 1, std::size_t targets = 1) {
  return at_random_home(built(kr5(targets), seed), seed);
}

inline Strokes strokes(int samples) {
  Strokes how;
  how.samples = samples;
  return how;
}

/// Where the arm of a forward kinematics apart from the simulation's has its target, in the base.
inline Eigen::Vector3d by_table(const Robot& robot, const std::vector<double>& angles,
                                std::size_t target = 0) {
  return identify::forward_kinematics(robot.arm, angles) * robot.targets_mm[target];
}

inline std::vector<double> angles_of(const identify::Sample& sample) {
  return {sample.angles_rad.begin(), sample.angles_rad.begin() + sample.joints};
}

/// Standard deviation of deviations from zero; of n of them it is known to 1 / sqrt(2 n).
struct Spread {
  double squares = 0;
  double most = 0;
  int count = 0;
  void add(double value) {
    squares += value * value;
    most = std::max(most, std::abs(value));
    ++count;
  }
  [[nodiscard]] double sigma() const { return std::sqrt(squares / count); }
  [[nodiscard]] double tolerance() const { return 5 / std::sqrt(2.0 * count); }  // five sigma
};

inline World exact_angles() {
  World world;
  world.angles = true;
  return world;
}

}  // namespace simulation::robots
