#include "identify/dh/dh.hpp"

#include "identify/geometry/angle.hpp"

namespace identify {

Eigen::Isometry3d transform(const DhRow& row) {
  using Eigen::AngleAxisd;
  using Eigen::Translation3d;
  using Eigen::Vector3d;
  return Eigen::Isometry3d(
      Translation3d(0, 0, row.b_mm) * AngleAxisd(row.theta_rad, Vector3d::UnitZ()) *
      Translation3d(row.a_mm, 0, 0) * AngleAxisd(row.alpha_rad, Vector3d::UnitX()) *
      AngleAxisd(row.beta_rad, Vector3d::UnitY()));
}

DhRow Arm::row_at(std::size_t joint, double angle_rad) const {
  DhRow row = rows[joint];
  const double turn = positive[joint] * (angle_rad - home_rad[joint]);
  if (is_linear(joint))
    row.b_mm += kLinear_mm * turn;
  else
    row.theta_rad += turn;
  return row;
}

Eigen::Isometry3d forward_kinematics(const Arm& arm, const std::vector<double>& angles_rad) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < arm.rows.size(); ++i)
    pose = pose * transform(arm.row_at(i, angles_rad[i]));
  return pose;
}

}  // namespace identify
