#include "identify/circle/seen_circle.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kSections = 12;
constexpr std::size_t kFewestInSection = 5;
/// Closer than this the plain fit will do; farther off, outliers may have turned it over.
constexpr double kSure_mm = 0.05;

Eigen::Matrix3Xd points_of(const JointResult& joint) {
  std::vector<Vector3d> points;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
    if (!joint.used[s] || joint.sweeps[s].target != joint.circle_target) continue;
    for (const Sample& sample : *joint.sweeps[s].samples)
      if (sample.has_position) points.push_back(sample.position_mm);
  }
  Eigen::Matrix3Xd columns(3, static_cast<Eigen::Index>(points.size()));
  Eigen::Index at = 0;
  for (const Vector3d& point : points) columns.col(at++) = point;
  return columns;
}

/// How far the middle one of the points is from a circle.
double usual_distance_mm(const CircleFit& circle, const Eigen::Matrix3Xd& points) {
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const CircleResidual off = residual(circle, points.col(i));
    distances.push_back(std::hypot(off.plane_mm, off.radial_mm));
  }
  return median_of(std::move(distances));
}

/// Of a circle whose points are `usual_mm` off.
std::optional<double> bent_mm(const CircleFit& circle, const Eigen::Matrix3Xd& points,
                              double usual_mm) {
  const Vector3d x = circle.normal.unitOrthogonal();
  const Vector3d y = circle.normal.cross(x);
  // Angles from the arc's middle: its ends are far from half a turn away.
  const Vector3d middle = points.rowwise().mean() - circle.center_mm;
  const double centre = std::atan2(middle.dot(y), middle.dot(x));
  struct Seen {
    double turn;
    CircleResidual off;
  };
  std::vector<Seen> seen;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const CircleResidual off = residual(circle, points.col(i));
    if (std::hypot(off.plane_mm, off.radial_mm) > kOutlierDistances * usual_mm) continue;
    const Vector3d arm = points.col(i) - circle.center_mm;
    seen.push_back({wrapped(std::atan2(arm.dot(y), arm.dot(x)) - centre), off});
  }
  if (seen.size() < kSections * kFewestInSection) return std::nullopt;
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.turn < b.turn; });
  double squares = 0;
  for (std::size_t k = 0; k < kSections; ++k) {
    std::vector<double> plane, radial;
    for (std::size_t i = k * seen.size() / kSections; i < (k + 1) * seen.size() / kSections; ++i) {
      plane.push_back(seen[i].off.plane_mm);
      radial.push_back(seen[i].off.radial_mm);
    }
    squares += std::pow(median_of(std::move(plane)), 2) + std::pow(median_of(std::move(radial)), 2);
  }
  return std::sqrt(squares / kSections);
}

}  // namespace

std::optional<SeenCircle> seen_circle(const JointResult& joint) {
  if (!joint.circle) return std::nullopt;
  const auto points = points_of(joint);
  SeenCircle seen{*joint.circle, usual_distance_mm(*joint.circle, points), {}};
  seen.bent_mm = bent_mm(seen.circle, points, seen.usual_mm);
  // Most of the time the plain fit will do.
  if (std::max(seen.circle.plane_rms_mm, seen.circle.radial_rms_mm) <= kSure_mm) return seen;
  const auto robust = fit_robust_circle(points);
  if (!robust) return seen;
  // Outliers may have turned the plain one over.
  const Vector3d positive = joint.axis ? joint.axis->direction : joint.circle->normal;
  const double sense = robust->normal.dot(positive) < 0 ? -1 : 1;
  seen.circle = *robust;
  seen.circle.normal *= sense;
  seen.usual_mm = usual_distance_mm(seen.circle, points);
  seen.bent_mm = bent_mm(seen.circle, points, seen.usual_mm);
  return seen;
}

}  // namespace identify
