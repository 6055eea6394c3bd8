#pragma once

#include <Eigen/Core>

namespace identify {

/// [v]x: its product with w is v x w.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

}  // namespace identify
