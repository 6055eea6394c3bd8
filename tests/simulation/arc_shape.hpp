#pragma once

#include <random>
#include <vector>

#include <Eigen/Core>

#include "tests/simulation/world.hpp"

namespace simulation {

/// How one arc departs from a circle (world.hpp): a smooth random function of the turn.
class ArcCurve {
 public:
  /// Over turns from `low_rad` to `high_rad`.
  ArcCurve(const ArcShape& shape, double low_rad, double high_rad, std::mt19937_64& random);

  /// Radial, axial, tangential, mm; zero for a turn of zero (home).
  [[nodiscard]] Eigen::Vector3d at(double turn_rad) const;

 private:
  [[nodiscard]] Eigen::Vector3d sum_at(double turn_rad) const;

  std::vector<Eigen::Vector3d> coefficients_;  ///< of Chebyshev polynomials, order 0 first
  double middle_rad_;
  double half_rad_;
  Eigen::Vector3d at_home_ = Eigen::Vector3d::Zero();
};

}  // namespace simulation
