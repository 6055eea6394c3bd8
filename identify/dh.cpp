#include "identify/dh.hpp"

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

Eigen::Isometry3d forward_kinematics(const Arm& arm, const std::vector<double>& angles_rad) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < arm.rows.size(); ++i) {
    DhRow row = arm.rows[i];
    row.theta_rad += arm.positive[i] * (angles_rad[i] - arm.home_rad[i]);
    pose = pose * transform(row);
  }
  return pose;
}

}  // namespace identify
