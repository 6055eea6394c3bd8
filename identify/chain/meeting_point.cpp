#include "identify/chain/meeting_point.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"

namespace identify {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d AxisCircle::arm(const Vector3d& point) const {
  const Vector3d from = point - axis.point_mm;
  return from - axis.direction * axis.direction.dot(from);
}

Vector3d AxisCircle::to_circle(const Vector3d& point) const {
  if (axis.linear) {
    const Vector3d off = on_it_mm - point;
    return off - axis.direction * axis.direction.dot(off);
  }
  const double height = axis.direction.dot(point - on_it_mm);
  const Vector3d here = arm(point);
  const double radius = arm(on_it_mm).norm();
  const double off = here.norm();
  const Vector3d outward = off > 0 ? Vector3d(here / off) : axis.direction.unitOrthogonal();
  return -(height * axis.direction + (off - radius) * outward);
}

double misfit(const std::vector<AxisCircle>& circles, const Vector3d& point) {
  double sum = 0;
  for (const AxisCircle& circle : circles) sum += circle.to_circle(point).squaredNorm();
  return sum;
}

Vector3d meeting_point(const std::vector<AxisCircle>& circles, Vector3d point) {
  constexpr int kSteps = 30;
  for (int step = 0; step < kSteps; ++step) {
    // Along its tangent a circle has no say; a little damping for where none has.
    Matrix3d normal = 1e-6 * Matrix3d::Identity();
    Vector3d right = Vector3d::Zero();
    for (const AxisCircle& circle : circles) {
      const Vector3d tangent = circle.axis.linear
                                   ? circle.axis.direction
                                   : circle.axis.direction.cross(circle.arm(point)).normalized();
      normal += Matrix3d::Identity() - tangent * tangent.transpose();
      right += circle.to_circle(point);
    }
    const Vector3d move = normal.ldlt().solve(right);
    if (!move.allFinite()) break;
    point += move;
    if (move.norm() < 1e-9) break;
  }
  return point;
}

Vector3d meeting_point(const std::vector<AxisCircle>& circles) {
  Vector3d best = Vector3d::Zero();
  if (circles.empty()) return best;
  // A line is met from anywhere; circles more than once.
  const auto turning = std::find_if(circles.begin(), circles.end(),
                                    [](const AxisCircle& circle) { return !circle.axis.linear; });
  if (turning == circles.end()) return meeting_point(circles, circles.front().on_it_mm);
  const AxisCircle& first = *turning;
  if (circles.size() == 1) return first.on_it_mm;
  double least = std::numeric_limits<double>::infinity();
  constexpr int kPlaces = 72;
  for (int k = 0; k < kPlaces; ++k) {
    const Vector3d point =
        meeting_point(circles, first.axis.point_mm +
                                   Eigen::AngleAxisd(2 * kPi * k / kPlaces, first.axis.direction) *
                                       (first.on_it_mm - first.axis.point_mm));
    const double sum = misfit(circles, point);
    if (sum < least) {
      least = sum;
      best = point;
    }
  }
  return best;
}

}  // namespace identify
