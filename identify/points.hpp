#pragma once

#include <vector>

#include <Eigen/Core>

#include "identify/sample.hpp"

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

}  // namespace identify
