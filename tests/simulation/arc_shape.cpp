#include "tests/simulation/arc_shape.hpp"

#include <algorithm>
#include <cmath>

namespace simulation {

ArcCurve::ArcCurve(const ArcShape& shape, double low_rad, double high_rad, std::mt19937_64& random)
    : middle_rad_((low_rad + high_rad) / 2), half_rad_((high_rad - low_rad) / 2) {
  constexpr int kOrders = 9;
  std::normal_distribution<> normal;
  std::vector<double> sigmas;
  double variance = 0;
  for (int m = 0; m < kOrders; ++m) {
    sigmas.push_back(std::pow(std::max(1, m), -shape.power));
    // The mean of T_m squared over the arc.
    variance += sigmas.back() * sigmas.back() * (0.5 - 0.5 / (4 * m * m - 1));
  }
  for (const double sigma : sigmas) {
    Eigen::Vector3d coefficient;
    for (double& one : coefficient)
      one = shape.rms_mm * sigma / std::sqrt(variance) * normal(random);
    coefficients_.push_back(coefficient);
  }
  at_home_ = sum_at(0);
}

Eigen::Vector3d ArcCurve::at(double turn_rad) const {
  return sum_at(turn_rad) - at_home_;
}

Eigen::Vector3d ArcCurve::sum_at(double turn_rad) const {
  const double x = std::clamp((turn_rad - middle_rad_) / half_rad_, -1.0, 1.0);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double before = x, here = 1;  // T_1 = T_-1
  for (const Eigen::Vector3d& coefficient : coefficients_) {
    sum += here * coefficient;
    const double next = 2 * x * here - before;
    before = here;
    here = next;
  }
  return sum;
}

}  // namespace simulation
