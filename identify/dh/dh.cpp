#include "identify/dh/dh.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/angle.hpp"

namespace identify {

// Eigen's products of rotations and translations, written out: of every fit the most frequent step.
Eigen::Isometry3d transform(const DhRow& row) {
  const double ct = std::cos(row.theta_rad), st = std::sin(row.theta_rad);
  const double ca = std::cos(row.alpha_rad), sa = std::sin(row.alpha_rad);
  const double cb = std::cos(row.beta_rad), sb = std::sin(row.beta_rad);
  Eigen::Isometry3d step;
  step.linear().row(0) << ct * cb - st * sa * sb, -st * ca, ct * sb + st * sa * cb;
  step.linear().row(1) << st * cb + ct * sa * sb, ct * ca, st * sb - ct * sa * cb;
  step.linear().row(2) << -ca * sb, sa, ca * cb;
  step.translation() << row.a_mm * ct, row.a_mm * st, row.b_mm;
  return step;
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

using Eigen::Vector3d;

Eigen::Isometry3d AxisFrame::pose() const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << x, z.cross(x), z;
  pose.translation() = origin_mm;
  return pose;
}

Vector3d turned_across(const Vector3d& v, const Vector3d& axis) {
  const Vector3d part = v - axis * axis.dot(v);
  return part.norm() > 1e-6 * v.norm() ? part.normalized() : Vector3d::Zero();
}

AxisStep step_to(const AxisFrame& from, const Line& next, Relation relation, const Vector3d& x_near,
                 double b_mm) {
  const bool parallel = relation == Relation::parallel || relation == Relation::coincident;
  const Vector3d& z = from.z;
  const Vector3d& n = next.direction;
  const Vector3d start = next.point_mm();
  // The next axis pierces a plane through this origin: the one across z, or, where the common
  // normal is known, the one that z and the normal span. So the row is exact even where rounding
  // puts the feet of the normal somewhere else along the axes.
  Vector3d x;
  Vector3d plane = z;
  if (!parallel) {
    x = turned_across(z.cross(n), z);
    plane = z.cross(x);
  }
  Vector3d foot = from.origin_mm;
  if (parallel && b_mm != 0) foot += b_mm * z;
  const Vector3d origin = start + n * (plane.dot(foot - start) / plane.dot(n));
  const Vector3d offset = origin - from.origin_mm;
  if (relation == Relation::parallel) x = turned_across(offset, z);
  if (relation == Relation::coincident || x.isZero()) x = turned_across(x_near, z);
  if (x.dot(x_near) < 0) x = -x;
  const Vector3d y = z.cross(x);

  AxisStep step;
  step.row.b_mm = parallel ? b_mm : offset.dot(z);
  step.row.theta_rad = std::atan2(z.dot(from.x.cross(x)), from.x.dot(x));
  step.row.a_mm = offset.dot(x);
  step.row.alpha_rad = std::atan2(-n.dot(y), n.dot(z));
  step.row.beta_rad = parallel ? std::asin(std::clamp(n.dot(x), -1.0, 1.0)) : 0;
  step.normal = x;
  step.frame = {origin, turned_across(x, n), n};
  return step;
}

}  // namespace identify
