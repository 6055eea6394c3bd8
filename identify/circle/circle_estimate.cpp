#include "identify/circle/circle_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/line.hpp"
#include "identify/geometry/line_fit.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/sweeps/stroke_correlation.hpp"
#include "identify/sweeps/stroke_moments.hpp"

namespace identify {
namespace {

double usual_noise(const CircleEstimate& found, double CircleFit::*rms) {
  std::vector<double> all;
  for (const JointResult& joint : found.joints)
    if (joint.circle) all.push_back((*joint.circle).*rms);
  if (all.empty()) return 0;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2),
                   all.end());
  return all[all.size() / 2];
}

/// How many successive samples are worth one independent one, by the strokes that were used.
double correlation_of(const CircleEstimate& found) {
  std::vector<StrokeMoments> strokes;
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const JointResult& joint = found.joints[j];
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      if (!joint.used[s] || joint.sweeps[s].target != joint.circle_target) continue;
      const StrokeContent content{j, 0, false, joint.line.has_value()};
      if (auto stroke = moments_of(joint.sweeps[s], content)) strokes.push_back(*std::move(stroke));
    }
  }
  return identify::correlation_of(strokes);
}

/// A single wrong sample would be most of a box.
Eigen::Matrix3Xd without_strays(Eigen::Matrix3Xd points, bool is_line) {
  const auto keep = [&](const auto& off_mm, double within_mm) {
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      if (off_mm(points.col(i)) <= within_mm) points.col(count++) = points.col(i);
    points.conservativeResize(3, count);
  };
  if (is_line) {
    if (const auto line = fit_line(points))
      keep([&](const auto& point) { return across(*line, point).norm(); }, line->within_mm);
  } else if (const auto usual = fit_usual_circle(points)) {
    keep(
        [&](const auto& point) {
          const CircleResidual off = residual(usual->circle, point);
          return std::hypot(off.plane_mm, off.radial_mm);
        },
        usual->within_mm);
  }
  return points;
}

Eigen::Matrix3Xd joined(const std::vector<Eigen::Matrix3Xd>& parts) {
  Eigen::Index count = 0;
  for (const auto& part : parts) count += part.cols();
  Eigen::Matrix3Xd all(3, count);
  count = 0;
  for (const auto& part : parts) {
    all.middleCols(count, part.cols()) = part;
    count += part.cols();
  }
  return all;
}

}  // namespace

std::set<std::size_t> used_targets(const JointResult& joint) {
  std::set<std::size_t> targets;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
    if (joint.used[s]) targets.insert(joint.sweeps[s].target);
  return targets;
}

std::vector<Sweep> used_sweeps(const JointResult& joint) {
  std::vector<Sweep> used;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
    if (joint.used[s] && joint.sweeps[s].target == joint.circle_target)
      used.push_back(joint.sweeps[s]);
  return used;
}

Eigen::Matrix3Xd used_points(const JointResult& joint, std::optional<std::size_t> target) {
  const auto wanted = [&](std::size_t s) {
    return joint.used[s] && (!target || joint.sweeps[s].target == *target);
  };
  Eigen::Index count = 0;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
    if (wanted(s)) count += static_cast<Eigen::Index>(joint.sweeps[s].samples->size());
  Eigen::Matrix3Xd points(3, count);
  count = 0;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
    if (wanted(s))
      for (const Sample& sample : *joint.sweeps[s].samples)
        if (sample.has_position) points.col(count++) = sample.position_mm;
  points.conservativeResize(3, count);
  return points;
}

void set_circle_axes(CircleEstimate& found, const Resolution& resolution) {
  const double plane = usual_noise(found, &CircleFit::plane_rms_mm);
  const double radial = usual_noise(found, &CircleFit::radial_rms_mm);
  const double quantum = kEvenlySpread * resolution.position_mm;
  const double size = size_by_circles_mm(found);
  const double correlation = correlation_of(found);
  for (JointResult& joint : found.joints) {
    Axis axis;
    if (joint.line) {
      const double noise = std::max({joint.line->across_rms_mm, plane, quantum});
      axis = {joint.line->direction, joint.line->point_mm, line_covariance(*joint.line, noise),
              true};
    } else if (joint.circle) {
      const CircleFit& circle = *joint.circle;
      axis = {circle.normal, circle.center_mm,
              axis_covariance(circle, used_points(joint, joint.circle_target),
                              std::max({circle.plane_rms_mm, plane, quantum}),
                              std::max({circle.radial_rms_mm, radial, quantum}))};
    } else {
      continue;
    }
    axis.covariance *= correlation;
    if (joint.off_home_rad) {
      const double square = *joint.off_home_rad * *joint.off_home_rad;
      const Eigen::Matrix3d off =
          square * (Eigen::Matrix3d::Identity() - axis.direction * axis.direction.transpose());
      axis.covariance.topLeftCorner<3, 3>() += off;
      axis.covariance.bottomRightCorner<3, 3>() += size * size * off;
    }
    if (axis.direction_sigma_rad() < kWorstDirection_rad) joint.axis = std::move(axis);
  }
}

double size_by_circles_mm(const CircleEstimate& found) {
  std::vector<Eigen::Vector3d> places;
  for (const JointResult& joint : found.joints) {
    if (joint.line) places.push_back(joint.line->point_mm);
    if (!joint.circle) continue;
    places.push_back(joint.circle->center_mm);
    places.push_back(joint.circle->center_mm +
                     joint.circle->radius_mm * joint.circle->normal.unitOrthogonal());
  }
  return largest_distance_mm(places);
}

void measure_boxes(CircleEstimate& found) {
  std::vector<Eigen::Matrix3Xd> of_joints;
  for (JointResult& joint : found.joints) {
    if (!joint.axis) continue;
    std::vector<Eigen::Matrix3Xd> of_targets;
    for (const std::size_t target : used_targets(joint))
      of_targets.push_back(without_strays(used_points(joint, target), joint.line.has_value()));
    of_joints.push_back(joined(of_targets));
    joint.box = minimum_bounding_box(of_joints.back());
  }
  const auto all = joined(of_joints);
  if (all.cols() > 0) found.bounding_box = minimum_bounding_box(all);
}

}  // namespace identify
