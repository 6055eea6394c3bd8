#include "identify/geometry/line.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace identify {

using Eigen::Vector3d;

Line Line::through(const Vector3d& point, const Vector3d& direction) {
  const Vector3d unit = direction.normalized();
  return {unit, point.cross(unit)};
}

Vector3d Line::point_mm() const {
  return direction.cross(moment_mm);
}

Vector3d Line::closest_mm(const Vector3d& from) const {
  return point_mm() + direction * direction.dot(from);
}

DualNumber dot(const Line& first, const Line& second) {
  return {first.direction.dot(second.direction),
          first.direction.dot(second.moment_mm) + first.moment_mm.dot(second.direction)};
}

LinePair relate(const Line& first, const Line& second) {
  LinePair pair;
  const DualNumber cosine = dot(first, second);
  pair.cross = first.direction.cross(second.direction);
  pair.sine = pair.cross.norm();
  pair.angle_rad = std::atan2(pair.sine, cosine.real);
  const Vector3d first_point = first.point_mm();
  const Vector3d between = second.point_mm() - first_point;
  if (pair.sine == 0) {
    pair.distance_mm = first.direction.cross(between).norm();
    return pair;
  }
  pair.distance_mm = -cosine.dual / pair.sine;
  const double squared = pair.cross.squaredNorm();
  const double first_t = between.cross(second.direction).dot(pair.cross) / squared;
  const double second_t = between.cross(first.direction).dot(pair.cross) / squared;
  pair.first_foot_mm = first_point + first_t * first.direction;
  pair.second_foot_mm = second.point_mm() + second_t * second.direction;
  return pair;
}

Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> both;
  both.col(0) = direction.unitOrthogonal();
  both.col(1) = direction.cross(both.col(0));
  return both;
}

}  // namespace identify
