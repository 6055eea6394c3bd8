#include "identify/circle/joint_motion.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/warning.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kSections = 12;
constexpr std::size_t kFewestInSection = 5;
/// Root mean squares beyond so many usual distances are those of strays.
constexpr double kStrays = 3;

/// Each stroke off a circle of its own, as its locked joints may have stood elsewhere; by where it
/// is about the circle of all, whose points are `usual_mm` off and have this `mean`.
std::optional<double> bent_mm(const JointResult& joint, const Vector3d& mean, double usual_mm) {
  const CircleFit& common = *joint.circle;
  const Vector3d x = common.normal.unitOrthogonal();
  const Vector3d y = common.normal.cross(x);
  // Angles from the arc's middle: its ends are far from half a turn away.
  const Vector3d middle = mean - common.center_mm;
  const double centre = std::atan2(middle.dot(y), middle.dot(x));
  struct Place {
    double turn;
    CircleResidual off;
  };
  std::vector<Place> seen;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
    if (!joint.used[s] || joint.sweeps[s].target != joint.circle_target) continue;
    const auto points = positions(*joint.sweeps[s].samples);
    auto own = fit_circle(points);
    if (own && std::max(own->plane_rms_mm, own->radial_rms_mm) > kStrays * usual_mm)
      own = fit_robust_circle(points);
    if (!own) continue;
    if (own->normal.dot(common.normal) < 0) own->normal = -own->normal;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const CircleResidual off = residual(*own, points.col(i));
      if (std::hypot(off.plane_mm, off.radial_mm) > kOutlierDistances * usual_mm) continue;
      const Vector3d arm = points.col(i) - common.center_mm;
      seen.push_back({wrapped(std::atan2(arm.dot(y), arm.dot(x)) - centre), off});
    }
  }
  if (seen.size() < kSections * kFewestInSection) return std::nullopt;
  std::sort(seen.begin(), seen.end(),
            [](const Place& a, const Place& b) { return a.turn < b.turn; });
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

double usual_distance_mm(const CircleFit& circle, const Eigen::Matrix3Xd& points) {
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const CircleResidual off = residual(circle, points.col(i));
    distances.push_back(std::hypot(off.plane_mm, off.radial_mm));
  }
  return median_of(std::move(distances));
}

std::optional<CircleScatter> circle_scatter(const JointResult& joint) {
  if (!joint.circle) return std::nullopt;
  const auto points = used_points(joint, joint.circle_target);
  const double usual_mm = usual_distance_mm(*joint.circle, points);
  return CircleScatter{usual_mm, bent_mm(joint, points.rowwise().mean(), usual_mm)};
}

namespace {

/// Motion so many times as fast as the slowest that noise does not hide is seen from end to end.
constexpr double kClearlySeen = 2;

}  // namespace

std::optional<JointMotion> joint_motion(const JointResult& joint) {
  std::vector<double> speeds;
  std::vector<double> steps;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
    if (!joint.used[s]) continue;
    const auto& samples = *joint.sweeps[s].samples;
    const std::size_t span = std::max<std::size_t>(1, samples.size() / 10);
    for (std::size_t i = samples.size() / 4 + span; i < samples.size() - samples.size() / 4; ++i) {
      const Sample& before = samples[i - span];
      const double time = samples[i].time_s - before.time_s;
      if (!samples[i].has_position || !before.has_position || !(time > 0)) continue;
      const double way = (samples[i].position_mm - before.position_mm).norm();
      speeds.push_back(way / time);
      steps.push_back(way / static_cast<double>(span));
    }
  }
  if (steps.empty()) return std::nullopt;
  return JointMotion{median_of(std::move(speeds)), median_of(std::move(steps))};
}

std::optional<Warning> mistold(const Sweep& sweep) {
  constexpr double kOthersTurn_rad = 5 * kDegree;
  if (sweep.defect != SweepDefect::too_short || !sweep.joint) return std::nullopt;
  const std::size_t joint = *sweep.joint;
  const auto circle = fit_circle(positions(*sweep.samples));
  if (circle && std::abs(circle->arc_rad * kDegree / sweep.range_rad - 1) < 0.05 &&
      circle->radial_rms_mm < 0.01 * circle->radius_mm * (1 - std::cos(circle->arc_rad / 2)))
    return Warning{"angles_in_radians", joint,
                   joint_name(joint) +
                       ": its target turned 57 times as far as told: name the "
                       "angles' columns a1_rad and so on"};
  for (std::size_t k = 0; k < sweep.first().joints; ++k) {
    const auto [least, most] = std::minmax_element(
        sweep.samples->begin(), sweep.samples->end(),
        [k](const Sample& a, const Sample& b) { return a.angles_rad[k] < b.angles_rad[k]; });
    const double turned = most->angles_rad[k] - least->angles_rad[k];
    if (k != joint && turned > kOthersTurn_rad)
      return Warning{"joints_exchanged", joint,
                     joint_name(joint) + ": while it is said to sweep, the angle of " +
                         joint_name(k) + " turns by " + fixed(turned / kDegree, 1) +
                         "°: the numbers of the joints or the columns of their angles are "
                         "exchanged, or both joints moved"};
  }
  return std::nullopt;
}

std::optional<Warning> hidden_motion(const CircleEstimate& found, const MotionLimit& limit) {
  if (!limit.by_noise()) return std::nullopt;
  const double clearly_mm_s = kClearlySeen * limit.slowest_mm_s;
  std::vector<std::size_t> hidden;
  double slowest_mm_s = clearly_mm_s;
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const auto moved = joint_motion(found.joints[j]);
    if (moved && found.joints[j].axis && moved->speed_mm_s >= clearly_mm_s) continue;
    hidden.push_back(j);
    if (moved) slowest_mm_s = std::min(slowest_mm_s, moved->speed_mm_s);
  }
  if (hidden.empty()) return std::nullopt;
  std::string message = "a position noise of " + brief(limit.noise_mm) +
                        " mm hides motion slower than " + brief(limit.slowest_mm_s) +
                        " mm/s and arcs shorter than " + brief(limit.shortest_mm) +
                        " mm: perhaps sweeps of " + joints_named(hidden) + ", or parts of them";
  if (slowest_mm_s < clearly_mm_s)
    message += ", where the target was seen to move at " + brief(slowest_mm_s) + " mm/s";
  message += "; sweep so fast that the target moves at " + brief(clearly_mm_s) +
             " mm/s or more, rest for half a second between moves, measure more target points at "
             "once, or let the device average more";
  return Warning{"motion_limit", std::nullopt, std::move(message)};
}

}  // namespace identify
