#pragma once

// Arms as results tell of them, for tests of what has changed.

#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "identify/change/compared_arms.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "tests/simulation/robot.hpp"

namespace identify::test {

/// How an arm was measured.
struct Measuring {
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  bool specified = true;  ///< else axes point along positive rotation, normals anywhere
  double direction_rad = 1e-5;
  double point_mm = 1e-2;
};

/// The true numbers of a robot at its home, with the covariance of axes that are independent.
inline MeasuredArm measured(const simulation::Robot& robot, const Measuring& how = {}) {
  MeasuredArm arm;
  const Chain chain = simulation::chain_of(robot);
  const auto joints = chain.axes.size();
  std::vector<std::optional<Axis>> axes;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * joints),
                                                     static_cast<Eigen::Index>(6 * joints));
  for (std::size_t j = 0; j < joints; ++j) {
    Axis axis{how.base.linear() * chain.axes[j].direction, how.base * chain.axes[j].point_mm};
    const auto basis = across(axis.direction);
    const Eigen::Matrix3d across_axis = basis * basis.transpose();
    axis.covariance.topLeftCorner<3, 3>() = std::pow(how.direction_rad, 2) * across_axis;
    axis.covariance.bottomRightCorner<3, 3>() = std::pow(how.point_mm, 2) * across_axis;
    const int positive = how.specified ? robot.arm.positive[j] : 1;
    if (positive < 0) axis = axis.reversed();
    const auto at = static_cast<Eigen::Index>(6 * j);
    covariance.block<6, 6>(at, at) = axis.covariance;
    axes.push_back(axis);
    arm.positive.push_back(positive);
  }
  constexpr double kSize_mm = 1500;
  const auto specified = how.specified ? robot.specified.rows : std::vector<DhRow>{};
  arm.dh = extract_dh(axes, kSize_mm, specified, covariance);
  Eigen::MatrixXd jacobian = dh_jacobian(axes, kSize_mm, specified);
  for (std::size_t i = 0; i < joints; ++i) {
    const auto numbers = numbers_of(arm.dh[i]);
    for (std::size_t k = 0; k < numbers.size(); ++k)
      if (numbers[k]->knowledge != Knowledge::identified)
        jacobian.row(static_cast<Eigen::Index>(5 * i + k)).setZero();
  }
  arm.covariance = jacobian * covariance * jacobian.transpose();
  arm.home_rad.assign(robot.arm.home_rad.begin(), robot.arm.home_rad.end());
  arm.gear.assign(joints, 0);
  return arm;
}

}  // namespace identify::test
