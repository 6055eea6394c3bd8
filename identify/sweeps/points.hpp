#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "identify/sweeps/sample.hpp"

namespace identify {

/// Columns: the positions of those samples that have one, in their order.
[[nodiscard]] inline Eigen::Matrix3Xd positions(const std::vector<Sample>& samples) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(samples.size()));
  Eigen::Index count = 0;
  for (const Sample& sample : samples)
    if (sample.has_position) points.col(count++) = sample.position_mm;
  points.conservativeResize(3, count);
  return points;
}

/// Of the tool, R = Rz(a) Ry(b) Rx(c).
[[nodiscard]] inline Eigen::Matrix3d orientation(const Sample& sample) {
  const auto [a, b, c] = sample.abc_rad;
  return (Eigen::AngleAxisd(a, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(b, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(c, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Coordinate by coordinate, the median: a few points anywhere do not shift it far. Reorders
/// `points`, of which there must be one at least.
[[nodiscard]] inline Eigen::Vector3d median(std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto at = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
    std::nth_element(
        points.begin(), at, points.end(),
        [k](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a(k) < b(k); });
    middle(k) = (*at)(k);
  }
  return middle;
}

}  // namespace identify
