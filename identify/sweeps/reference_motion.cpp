#include "identify/sweeps/reference_motion.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/line_fit.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d ReferenceMotion::turned(double by_rad) const {
  if (linear) return Matrix3d::Identity();
  return Matrix3d(Eigen::AngleAxisd(sense * by_rad, circle.normal));
}

Matrix3d ReferenceMotion::directions(double turn_rad) const {
  const Vector3d outward =
      linear ? arm
             : Vector3d(Eigen::AngleAxisd(sense * (turn_rad - zero_rad), circle.normal) * arm);
  Matrix3d rows;
  rows.row(0) = outward.transpose();
  rows.row(1) = circle.normal.transpose();
  rows.row(2) = circle.normal.cross(outward).transpose();
  return rows;
}

double ReferenceMotion::angle_about(const Vector3d& point_mm) const {
  const Vector3d from = point_mm - circle.center_mm;
  if (linear) return circle.normal.cross(arm).dot(from) / circle.radius_mm;
  return std::atan2(circle.normal.dot(arm.cross(from)), arm.dot(from));
}

double ReferenceMotion::step(double last_rad, double angle_rad) const {
  const double by = angle_rad - last_rad;
  return linear ? by : short_way(by);
}

Eigen::Vector2d ReferenceMotion::across(const Vector3d& point_mm) const {
  const Vector3d from = point_mm - circle.center_mm;
  const double height = circle.normal.dot(from);
  if (linear) return {arm.dot(from), height};
  return {(from - height * circle.normal).norm() - circle.radius_mm, height};
}

Vector3d ReferenceMotion::departure(const Vector3d& point_mm, double turn_rad) const {
  const Eigen::Vector2d off = across(point_mm);
  const double along = step(sense * (turn_rad - zero_rad), angle_about(point_mm));
  return {off.x(), off.y(), along * circle.radius_mm};
}

Vector3d ReferenceMotion::departure(const Matrix3d& tool, double turn_rad, double told_rad) const {
  const Matrix3d there = turned(told_rad - zero_rad) * orientation;
  const Eigen::AngleAxisd off(Matrix3d(tool * there.transpose()));
  return directions(turn_rad) * Vector3d(off.angle() * off.axis());
}

Vector3d ReferenceMotion::place(double turn_rad, const Vector3d& departure) const {
  const Matrix3d at = directions(turn_rad);
  if (linear) {
    const double way = sense * (turn_rad - zero_rad) * circle.radius_mm;
    return circle.center_mm + at.transpose() * (departure + Vector3d(0, 0, way));
  }
  const double ahead = departure.z() / circle.radius_mm;
  const Vector3d outward = Eigen::AngleAxisd(ahead, circle.normal) * Vector3d(at.row(0));
  return circle.center_mm + (circle.radius_mm + departure.x()) * outward +
         departure.y() * circle.normal;
}

void ReferenceMotion::shift(double by_rad) {
  if (linear)
    circle.center_mm += by_rad * circle.radius_mm * circle.normal.cross(arm);
  else
    arm = Eigen::AngleAxisd(by_rad, circle.normal) * arm;
}

bool set_reference(ReferenceMotion& motion, const Eigen::Matrix3Xd& points,
                   const Vector3d& middle) {
  if (motion.linear) {
    const auto line = fit_line(points);
    if (!line) return false;
    motion.circle.center_mm = line->point_mm;
    motion.circle.radius_mm = kLinear_mm;
    motion.circle.plane_rms_mm = motion.circle.radial_rms_mm = line->across_rms_mm;
    motion.circle.normal = line->direction.unitOrthogonal();
    motion.arm = line->direction.cross(motion.circle.normal);
    return true;
  }
  const auto circle = fit_robust_circle(points);
  if (!circle) return false;
  motion.circle = *circle;
  const Vector3d from = middle - circle->center_mm;
  const Vector3d across = from - circle->normal * circle->normal.dot(from);
  motion.arm = across.norm() > 0 ? Vector3d(across.normalized()) : circle->normal.unitOrthogonal();
  return true;
}

}  // namespace identify
