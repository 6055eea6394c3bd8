#include "identify/dh/upright.hpp"

#include <cmath>

#include <Eigen/SVD>

namespace identify {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The rotation that takes one frame's directions to the other's best: Kabsch, Acta Cryst. A32
// (1976) 922.
std::optional<Vector3d> up_among(const std::vector<std::optional<Vector3d>>& seen, const Arm& arm,
                                 const Vector3d& up) {
  Matrix3d products = Matrix3d::Zero();
  Matrix3d frame = Matrix3d::Identity();
  for (std::size_t j = 0; j < arm.joints(); ++j) {
    if (seen[j]) products += arm.positive[j] * *seen[j] * frame.col(2).transpose();
    frame = frame * transform(arm.rows[j]).linear();
  }
  const Eigen::JacobiSVD<Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d& sizes = svd.singularValues();
  if (!(sizes(0) > 0)) return std::nullopt;
  constexpr double kAllParallel = 0.01;
  if (sizes(1) < kAllParallel * sizes(0)) {
    const double along = svd.matrixV().col(0).dot(up);
    if (!is_upright(svd.matrixV().col(0), up)) return std::nullopt;
    return Vector3d(std::copysign(1.0, along) * svd.matrixU().col(0));
  }
  Matrix3d turn = svd.matrixU();
  turn.col(2) *= (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return Vector3d(turn * svd.matrixV().transpose() * up);
}

bool is_upright(const Vector3d& direction, const Vector3d& up) {
  constexpr double kUpright = 0.996;  // the cosine of 5 degrees
  return std::abs(direction.dot(up)) > kUpright;
}

}  // namespace identify
