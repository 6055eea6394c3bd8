#include "daemon/plan/pose_rules.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kBetweenPoints_mm = 10;
constexpr double kBetweenLooks_rad = 5 * identify::kDegree;

/// Points from the last one up to `to`, even.
void append_line(std::vector<Vector3d>& points, const Vector3d& to) {
  const Vector3d from = points.back();
  const auto count = static_cast<int>(std::ceil((to - from).norm() / kBetweenPoints_mm));
  for (int k = 1; k <= count; ++k) points.push_back(from + (to - from) * k / count);
}

double distance_to_segment(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  const Vector3d along = to - from;
  const double square = along.squaredNorm();
  const double share = square > 0 ? std::clamp((point - from).dot(along) / square, 0.0, 1.0) : 0;
  return (point - from - share * along).norm();
}

}  // namespace

bool Box::holds(const Vector3d& point, double room_mm) const {
  return (point.array() >= low.array() - room_mm).all() &&
         (point.array() <= high.array() + room_mm).all();
}

std::string words(PoseRule rule) {
  switch (rule) {
    case PoseRule::keep_out:
      return "in a box to keep out of";
    case PoseRule::floor:
      return "below the floor";
    case PoseRule::column:
      return "in the robot's base column";
    case PoseRule::cone:
      return "the reflector looks away from the device";
    case PoseRule::arm_between:
      return "the arm is between target and device";
    case PoseRule::way:
      return "the way from home passes where the arm must not be";
  }
  return "";
}

PoseRules::PoseRules(const identify::Arm& arm, const PoseLimits& limits)
    : arm_(arm), limits_(limits) {
  limits_.facing.normalize();
  if (arm.joints() > 1) shoulder_mm_ = transform(arm.rows[0]).translation().z();
}

PoseRules::Place PoseRules::place(const std::vector<double>& angles_rad) const {
  Place at;
  Isometry3d frame = Isometry3d::Identity();
  at.points.push_back(frame.translation());
  for (std::size_t j = 0; j < arm_.joints(); ++j) {
    if (j == 2) at.beyond_elbow = at.points.size();
    if (j + 1 == arm_.joints()) at.beyond_wrist = at.points.size();
    const identify::DhRow row = arm_.row_at(j, angles_rad[j]);
    append_line(at.points, frame * Vector3d(0, 0, row.b_mm));
    frame = frame * transform(row);
    append_line(at.points, frame.translation());
  }
  append_line(at.points, frame * Vector3d(0, 0, arm_.tool_mm.z()));
  append_line(at.points, frame * arm_.tool_mm);
  at.facing = frame.linear() * limits_.facing;
  return at;
}

std::optional<PoseRule> PoseRules::in_the_way(const Place& at) const {
  for (const Box& box : limits_.keep_out)
    for (const Vector3d& point : at.points)
      if (box.holds(point, kBetweenPoints_mm / 2)) return PoseRule::keep_out;
  for (std::size_t k = at.beyond_elbow; k < at.points.size(); ++k) {
    const Vector3d& point = at.points[k];
    if (limits_.floor_mm && point.z() < *limits_.floor_mm) return PoseRule::floor;
    if (limits_.column_mm && point.z() < shoulder_mm_ &&
        point.head<2>().norm() < *limits_.column_mm)
      return PoseRule::column;
  }
  return std::nullopt;
}

std::optional<PoseRule> PoseRules::unseen(const Place& at) const {
  if (!limits_.device_mm) return std::nullopt;
  const Vector3d& target = at.points.back();
  const Vector3d sight = *limits_.device_mm - target;
  if (limits_.cone_deg &&
      at.facing.dot(sight) < (std::cos(radians(*limits_.cone_deg)) - 1e-9) * sight.norm())
    return PoseRule::cone;
  if (limits_.arm_radius_mm <= 0) return std::nullopt;
  for (std::size_t k = 0; k < at.beyond_wrist; ++k) {
    const Vector3d& point = at.points[k];
    // What the target hangs on so closely is not between.
    if ((point - target).norm() > limits_.arm_radius_mm &&
        distance_to_segment(point, target, *limits_.device_mm) < limits_.arm_radius_mm)
      return PoseRule::arm_between;
  }
  return std::nullopt;
}

std::optional<PoseRule> PoseRules::in_the_way(const std::vector<double>& angles_rad) const {
  return in_the_way(place(angles_rad));
}

std::optional<PoseRule> PoseRules::broken(const std::vector<double>& angles_rad) const {
  const Place at = place(angles_rad);
  if (const auto rule = in_the_way(at)) return rule;
  if (const auto rule = unseen(at)) return rule;
  if (!free_way(arm_.home_rad, angles_rad)) return PoseRule::way;
  return std::nullopt;
}

bool PoseRules::free_way(const std::vector<double>& from_rad,
                         const std::vector<double>& to_rad) const {
  if (limits_.keep_out.empty() && !limits_.floor_mm && !limits_.column_mm) return true;
  double most = 0;
  for (std::size_t j = 0; j < from_rad.size(); ++j)
    most = std::max(most, std::abs(to_rad[j] - from_rad[j]));
  const auto looks = static_cast<int>(std::ceil(most / kBetweenLooks_rad));
  std::vector<double> at = from_rad;
  for (int look = 1; look < looks; ++look) {
    for (std::size_t j = 0; j < at.size(); ++j)
      at[j] = from_rad[j] + (to_rad[j] - from_rad[j]) * look / looks;
    if (in_the_way(at)) return false;
  }
  return true;
}

}  // namespace sweepd
