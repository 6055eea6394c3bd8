#include "identify/chain/chain_start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/sweeps/home.hpp"
#include "identify/sweeps/sample.hpp"

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

namespace {

/// From `point` on, until a step is shorter than `short_mm`.
Vector3d meeting_point(const std::vector<AxisCircle>& circles, Vector3d point, double short_mm) {
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
    const Vector3d move = normal.inverse() * right;
    if (!move.allFinite()) break;
    point += move;
    if (move.norm() < short_mm) break;
  }
  return point;
}

}  // namespace

Vector3d meeting_point(const std::vector<AxisCircle>& circles, const Vector3d& start) {
  return meeting_point(circles, start, 1e-9);
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
  constexpr double kShort_mm = 1e-3;  // what is left then, decides between no two places
  for (int k = 0; k < kPlaces; ++k) {
    const Vector3d point = meeting_point(
        circles,
        first.axis.point_mm + Eigen::AngleAxisd(2 * kPi * k / kPlaces, first.axis.direction) *
                                  (first.on_it_mm - first.axis.point_mm),
        kShort_mm);
    const double sum = misfit(circles, point);
    if (sum < least) {
      least = sum;
      best = point;
    }
  }
  return meeting_point(circles, best);
}

namespace {

using Eigen::Vector3d;

/// A target close to the axis does not tell where along its circle it is.
bool hardly_moves(const Sweep& sweep, const ChainAxis& axis) {
  if (axis.linear) return false;
  constexpr double kLeastRadius_mm = 1;
  std::vector<Vector3d> places;
  for (const Sample& sample : *sweep.samples) {
    const Vector3d from = sample.position_mm - axis.point_mm;
    places.emplace_back((from - axis.direction * axis.direction.dot(from)).norm(), 0, 0);
  }
  return median(places).x() < kLeastRadius_mm;
}

/// The used sweeps of a joint in which the target moves.
std::vector<bool> moving(const JointResult& joint, const ChainAxis& axis) {
  std::vector<bool> moves = joint.used;
  for (std::size_t s = 0; s < moves.size(); ++s)
    moves[s] = moves[s] && !hardly_moves(joint.sweeps[s], axis);
  return moves;
}

bool any_moves(const std::vector<bool>& moves) {
  return std::find(moves.begin(), moves.end(), true) != moves.end();
}

/// Positive where a sweep turns about the circle's normal: by the medians of its thirds.
double turned_by(const Sweep& sweep, const CircleFit& circle) {
  std::array<Vector3d, 3> places;
  for (std::size_t third = 0; third < 3; ++third) {
    std::vector<Vector3d> points;
    const std::size_t count = sweep.samples->size();
    for (std::size_t i = third * count / 3; i < (third + 1) * count / 3; ++i)
      if ((*sweep.samples)[i].has_position) points.push_back((*sweep.samples)[i].position_mm);
    if (points.empty()) return 0;
    places[third] = median(points) - circle.center_mm;
  }
  return circle.normal.dot(places[0].cross(places[1]) + places[1].cross(places[2]));
}

/// By so much (a sum of squared distances) circles may miss the place where they meet: two that
/// meet twice may pass nearer to each other at the wrong one.
double unsure(const std::vector<AxisCircle>& circles) {
  constexpr double kShare = 1e-3;  // of the radius: what an arc leaves open of its circle
  double sum = 0;
  for (const AxisCircle& circle : circles)
    if (!circle.axis.linear) sum += (kShare * circle.arm(circle.on_it_mm)).squaredNorm();
  return sum;
}

double turn_between(const ChainAxis& axis, const Vector3d& from, const Vector3d& to) {
  const Vector3d& z = axis.direction;
  if (axis.linear) return z.dot(to - from) / kLinear_mm;
  return std::atan2(z.dot(from.cross(to)), from.dot(to) - z.dot(from) * z.dot(to));
}

}  // namespace

std::vector<std::optional<ChainAxis>> starting_axes(const CircleEstimate& circles) {
  std::vector<std::optional<ChainAxis>> axes;
  for (const JointResult& joint : circles.joints) {
    axes.emplace_back();
    if (joint.line && joint.axis)
      axes.back() = ChainAxis{joint.axis->direction, joint.line->point_mm, true};
    if (!joint.circle) continue;
    const std::vector<Sweep> used = used_sweeps(joint);
    const Eigen::Matrix3Xd points = used_points(joint, joint.circle_target);
    const auto circle = fit_robust_circle(points);
    if (!circle) continue;
    const double noise = std::max({circle->plane_rms_mm, circle->radial_rms_mm, 1e-9});
    const Axis axis{circle->normal, circle->center_mm,
                    axis_covariance(*circle, points, noise, noise)};
    if (!(axis.direction_sigma_rad() < kWorstDirection_rad)) continue;
    // Which way is positive: by the motion, but a few points far off must not tell. Where the
    // specified table had to tell, the circle's axis points against its normal.
    double turned = 0;
    for (const Sweep& sweep : used) turned += sweep.direction * turned_by(sweep, *circle);
    if (turned == 0) turned = circle->normal.dot(joint.circle->normal);
    if (joint.axis && joint.axis->direction.dot(joint.circle->normal) < 0) turned = -turned;
    axes.back() =
        ChainAxis{turned < 0 ? Vector3d(-circle->normal) : circle->normal, circle->center_mm};
    const bool told = std::all_of(used.begin(), used.end(), [&](const Sweep& sweep) {
      return sweep.first().joints >= circles.joints.size();
    });
    if (!told && !any_moves(moving(joint, *axes.back()))) axes.back() = std::nullopt;
  }
  return axes;
}

bool tells_from_elsewhere(const Sweep& sweep, std::vector<std::optional<double>> home_rad,
                          const std::vector<bool>& known) {
  if (sweep.positioning || sweep.first().joints < known.size()) return false;
  home_rad.resize(known.size());
  for (std::size_t k = 0; k < known.size(); ++k)
    if (known[k]) home_rad[k] = std::nullopt;
  return off_home_rad(sweep, home_rad) <= kSameHome_rad;
}

std::vector<ChainSweep> chain_sweeps(const CircleEstimate& circles,
                                     const std::vector<std::optional<ChainAxis>>& axes) {
  std::vector<ChainSweep> found;
  const std::vector<bool> known = known_of(axes);
  for (std::size_t j = 0; j < known.size(); ++j) {
    const JointResult& joint = circles.joints[j];
    if (!axes[j]) continue;
    // Without a sweep of its own nothing would tell how uncertain its axis is.
    std::vector<bool> own = moving(joint, *axes[j]);
    if (!any_moves(own)) own = joint.used;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      const Sweep& sweep = joint.sweeps[s];
      if (own[s] || (!joint.used[s] && tells_from_elsewhere(sweep, circles.home_rad, known)))
        found.push_back({j, &sweep});
    }
  }
  return found;
}

std::vector<ChainObservation> chain_samples(const CircleEstimate& circles,
                                            const std::vector<std::optional<ChainAxis>>& axes) {
  std::vector<ChainObservation> found;
  const std::size_t joints = circles.joints.size();
  std::vector<std::optional<double>> home = circles.home_rad;
  home.resize(joints);
  std::size_t count = 0;
  for (const ChainSweep& one : chain_sweeps(circles, axes)) {
    const Sweep& sweep = *one.sweep;
    const bool told = sweep.first().joints >= joints;
    if (told && !home[one.joint]) home[one.joint] = sweep.first().angles_rad[one.joint];
    for (const Sample& sample : *sweep.samples) {
      if (!sample.has_position || !sample.position_mm.allFinite()) continue;
      ChainObservation seen;
      seen.position_mm = sample.position_mm;
      seen.joint = one.joint;
      seen.target = sweep.target;
      seen.sweep = count;
      seen.falling = sweep.direction < 0;
      if (sample.has_orientation) seen.orientation = orientation(sample);
      for (std::size_t k = 0; told && k < joints; ++k)
        if (axes[k] && home[k]) seen.turns[k] = sample.angles_rad[k] - *home[k];
      seen.measured_turn = seen.turns[one.joint];
      found.push_back(seen);
    }
    ++count;
  }
  return found;
}

std::vector<Vector3d> starting_targets(const Chain& chain,
                                       std::vector<ChainObservation>& observations,
                                       std::size_t targets, bool with_angles) {
  std::vector<Vector3d> found;
  for (std::size_t target = 0; target < targets; ++target) {
    // Each joint's samples, brought back to where the other joints are at home.
    std::vector<std::vector<Vector3d>> arcs(chain.axes.size());
    std::vector<Vector3d> at_home;
    for (const ChainObservation& sample : observations) {
      if (sample.target != target) continue;
      Turns before{};
      std::copy_n(sample.turns.begin(), sample.joint, before.begin());
      // With a joint behind it elsewhere the target runs on another circle.
      const bool home = std::all_of(
          sample.turns.begin() + static_cast<std::ptrdiff_t>(sample.joint) + 1, sample.turns.end(),
          [](double turn) { return std::abs(turn) < kSameHome_rad; });
      if (home)
        arcs[sample.joint].push_back(chain.displacement(before).inverse() * sample.position_mm);
      if (with_angles)
        at_home.push_back(chain.displacement(sample.turns).inverse() * sample.position_mm);
    }
    std::vector<AxisCircle> circles;
    for (std::size_t j = 0; j < arcs.size(); ++j) {
      if (arcs[j].empty()) continue;
      // Heights and radii each by their median: one point far off must not be the circle.
      AxisCircle circle{chain.axes[j], Vector3d::Zero()};
      std::vector<Vector3d> places;
      for (const Vector3d& point : arcs[j])
        places.emplace_back(chain.axes[j].direction.dot(point - chain.axes[j].point_mm),
                            circle.arm(point).norm(), 0);
      const Vector3d middle = median(places);
      circle.on_it_mm = chain.axes[j].linear
                            ? median(arcs[j])
                            : chain.axes[j].point_mm + middle(0) * chain.axes[j].direction +
                                  middle(1) * chain.axes[j].direction.unitOrthogonal();
      circles.push_back(circle);
    }
    Vector3d best = meeting_point(circles);
    if (!at_home.empty()) {
      // Where the angles lead to about as good a place, they know which of several it is.
      constexpr double kAsGood = 0.1;
      const Vector3d told = median(at_home);
      const Vector3d point = circles.size() > 1 ? meeting_point(circles, told) : told;
      if (circles.size() <= 1 ||
          misfit(circles, point) * kAsGood < misfit(circles, best) + unsure(circles))
        best = point;
    }
    found.push_back(best);
  }
  for (ChainObservation& sample : observations) {
    const ChainAxis& axis = chain.axes[sample.joint];
    Turns before{};
    Turns after = sample.turns;
    std::copy_n(sample.turns.begin(), sample.joint, before.begin());
    std::fill_n(after.begin(), sample.joint + 1, 0.0);
    const Vector3d arm = chain.displacement(before).inverse() * sample.position_mm - axis.point_mm;
    const Vector3d from = chain.displacement(after) * found[sample.target] - axis.point_mm;
    sample.turns[sample.joint] = turn_between(axis, from, arm);
  }
  return found;
}

Matrix3d starting_tool(const Chain& chain, const std::vector<ChainObservation>& observations) {
  Matrix3d rotation = Matrix3d::Zero();
  for (const ChainObservation& sample : observations)
    rotation +=
        sample.weight * chain.displacement(sample.turns).linear().transpose() * sample.orientation;
  // Polar decomposition by Newton's iteration (Higham 1986).
  for (int k = 0; k < 30 && std::abs(rotation.determinant()) > 1e-300; ++k)
    rotation = 0.5 * (rotation + rotation.inverse().transpose());
  if (!rotation.allFinite() || rotation.determinant() <= 0) return Matrix3d::Identity();
  return Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
}

}  // namespace identify
