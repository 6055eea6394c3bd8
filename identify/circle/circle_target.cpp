#include "identify/circle/circle_target.hpp"

#include <limits>
#include <set>

#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/line_fit.hpp"

namespace identify {
namespace {

/// Of the axis that a target's points turn about; infinite without one.
double direction_sigma_rad(const JointResult& joint, std::size_t target) {
  const auto points = used_points(joint, target);
  const auto usual = points.cols() > 0 ? fit_usual_circle(points) : std::nullopt;
  if (!usual) return std::numeric_limits<double>::infinity();
  const CircleFit& circle = usual->circle;
  Axis axis{circle.normal, circle.center_mm, {}};
  axis.covariance = axis_covariance(circle, points, circle.plane_rms_mm, circle.radial_rms_mm);
  return axis.direction_sigma_rad();
}

}  // namespace

std::size_t circle_target(const JointResult& joint) {
  const std::set<std::size_t> targets = used_targets(joint);
  std::size_t best = *targets.begin();
  if (targets.size() == 1) return best;
  double least_rad = direction_sigma_rad(joint, best);
  if (least_rad < kWorstDirection_rad) return best;
  for (const std::size_t target : targets) {
    const double sigma_rad = direction_sigma_rad(joint, target);
    if (!(sigma_rad < kWorstDirection_rad && sigma_rad < least_rad)) continue;
    best = target;
    least_rad = sigma_rad;
  }
  return best;
}

}  // namespace identify
