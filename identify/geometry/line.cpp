#include "identify/geometry/line.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "identify/geometry/symmetric_eigen.hpp"

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

double largest_distance_mm(const std::vector<Vector3d>& places) {
  double size = 1;
  for (const auto& a : places)
    for (const auto& b : places) size = std::max(size, (a - b).norm());
  return size;
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
  constexpr double kAlong = 0.8;
  const Eigen::Vector3d aside =
      std::abs(direction.x()) < kAlong ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix<double, 3, 2> both;
  both.col(0) = (aside - aside.dot(direction) * direction).normalized();
  both.col(1) = direction.cross(both.col(0));
  return both;
}

namespace {

using Eigen::Matrix3d;

constexpr double kUncertainFoot = 0.02;  // of the arm's size
constexpr double kReach = 2;             // in sizes of the arm
constexpr double kRelationSigmas = 3;
constexpr double kAlmostParallel = 0.0175;  // sine of a degree
constexpr double kNoDirection_rad = 0.25;   // of two axes together: nothing tells how they lie
constexpr double kDirectionRounding_rad = 1e-15;  // no direction is better known

}  // namespace

std::string_view text(Relation relation) noexcept {
  switch (relation) {
    case Relation::skew:
      return "skew";
    case Relation::parallel:
      return "parallel";
    case Relation::intersecting:
      return "intersecting";
    case Relation::coincident:
      return "coincident";
    case Relation::last:
      return "last";
    case Relation::unknown:
      return "unknown";
  }
  return "";
}

Axis Axis::reversed() const {
  Axis axis = *this;
  axis.direction = -direction;
  axis.covariance.topRightCorner<3, 3>() *= -1;
  axis.covariance.bottomLeftCorner<3, 3>() *= -1;
  return axis;
}

double Axis::direction_sigma_rad() const {
  return largest_sigma(covariance.topLeftCorner<3, 3>());
}

double Axis::point_sigma_mm() const {
  const Matrix3d across_it = Matrix3d::Identity() - direction * direction.transpose();
  return largest_sigma(across_it * covariance.bottomRightCorner<3, 3>() * across_it);
}

Relation relation_between(const Axis& first, const Axis& second, double size) {
  const LinePair pair = relate(first.line(), second.line());
  const double direction_sigma =
      std::hypot(first.direction_sigma_rad(), second.direction_sigma_rad(), kDirectionRounding_rad);
  const double point_sigma = std::hypot(first.point_sigma_mm(), second.point_sigma_mm());
  if (!(direction_sigma < kNoDirection_rad) || !std::isfinite(point_sigma))
    return Relation::unknown;
  const double offset = first.direction.cross(second.point_mm - first.point_mm).norm();

  bool parallel = pair.sine < kExact;
  double lever = size;
  if (!parallel) {
    // The foot moves by a sigma_dir / sin^2 where the axes are apart, sigma_point / sin where they
    // meet.
    const double foot_sigma =
        std::hypot(point_sigma, size * direction_sigma) / pair.sine +
        std::abs(pair.distance_mm) * direction_sigma / (pair.sine * pair.sine);
    lever = std::max((pair.first_foot_mm - first.point_mm).norm(),
                     (pair.second_foot_mm - second.point_mm).norm());
    const bool almost = pair.sine < std::max(kAlmostParallel, kRelationSigmas * direction_sigma);
    // Where a linear joint's axis has its common normal is a convention.
    parallel = almost && (first.linear || second.linear || foot_sigma > kUncertainFoot * size ||
                          lever > kReach * size);
  }
  if (parallel) lever = size;
  const double distance = parallel ? offset : std::abs(pair.distance_mm);
  const double distance_sigma = std::hypot(point_sigma, lever * direction_sigma);
  const bool touching = distance < std::max(kRelationSigmas * distance_sigma, kExact * size);
  if (parallel) return touching ? Relation::coincident : Relation::parallel;
  return touching ? Relation::intersecting : Relation::skew;
}

}  // namespace identify
