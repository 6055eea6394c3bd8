#include "identify/correction/wrist_arm.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Numbers of a table are given to fewer digits.
constexpr double kMeet_mm = 1e-6;
constexpr double kSameDirection = 1e-9;

/// The turns about the unit `axis` that bring the component along `along` of `turned` to `wanted`.
/// Two, equal where it can only just be reached; none where it cannot.
std::vector<double> turns_to(const Vector3d& axis, const Vector3d& along, const Vector3d& turned,
                             double wanted) {
  const double fixed = axis.dot(turned) * axis.dot(along);
  const double a = along.dot(turned) - fixed;
  const double b = along.dot(axis.cross(turned));
  const double c = wanted - fixed;
  const double size = std::hypot(a, b);
  if (std::abs(c) > size * (1 + kSameDirection) + kSameDirection) return {};
  const double middle = std::atan2(b, a);
  const double aside = std::atan2(std::sqrt(std::max(0.0, (size - c) * (size + c))), c);
  return {middle + aside, middle - aside};
}

/// The turn about the unit `axis` from one direction to another, both seen along it.
double turn_from(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  const Vector3d across = from - axis * axis.dot(from);
  return std::atan2(axis.dot(across.cross(to)), across.dot(to));
}

Matrix3d rotation(const Vector3d& axis, double angle) {
  return AngleAxisd(angle, axis).toRotationMatrix();
}

double wrap(double angle) {
  return std::remainder(angle, 2 * kPi);
}

}  // namespace

std::optional<WristArm> WristArm::of(const Arm& arm) {
  if (arm.joints() != 6) return std::nullopt;
  WristArm found;
  Isometry3d frame = Isometry3d::Identity();
  for (std::size_t j = 0; j < 6; ++j) {
    if (arm.is_linear(j)) return std::nullopt;
    found.axes_[j] = {arm.positive[j] * frame.linear().col(2), frame.translation()};
    frame = frame * transform(arm.row_at(j, 0));
  }
  found.frame_ = frame;
  const auto& axes = found.axes_;
  const Vector3d across = axes[4].direction.cross(axes[3].direction);
  if (axes[1].direction.cross(axes[2].direction).norm() > kSameDirection || across.norm() < 0.1 ||
      axes[0].direction.cross(axes[1].direction).norm() < 0.1 ||
      axes[4].direction.cross(axes[5].direction).norm() < 0.1)
    return std::nullopt;
  // Where axis 5 comes closest to axis 4, which is on it and on axis 6.
  const Vector3d apart = axes[4].point - axes[3].point;
  found.wrist_ =
      axes[3].point +
      axes[3].direction *
          (apart.cross(axes[4].direction).dot(axes[3].direction.cross(axes[4].direction)) /
           across.squaredNorm());
  for (const std::size_t j : {4UL, 5UL})
    if ((found.wrist_ - axes[j].point).cross(axes[j].direction).norm() > kMeet_mm)
      return std::nullopt;
  return found;
}

Posture WristArm::posture(const Angles& angles) const {
  const Vector3d elbow = axes_[2].point - axes_[1].point;
  const Vector3d forearm = rotation(axes_[2].direction, angles[2]) * (wrist_ - axes_[2].point);
  const Vector3d in_first =  // the wrist's centre where the first joint stands at zero
      axes_[1].point + rotation(axes_[1].direction, angles[1]) * (elbow + forearm);
  Posture found;
  found.overhead = (in_first - axes_[0].point).x() < 0;
  found.bent_up = axes_[2].direction.dot(elbow.cross(forearm)) >= 0;
  found.flipped = wrap(angles[4]) < 0;
  return found;
}

std::optional<WristArm::Angles> WristArm::angles_at(const Isometry3d& pose,
                                                    const Posture& posture) const {
  const Isometry3d moved = pose * frame_.inverse();
  const Vector3d from_first = moved * wrist_ - axes_[0].point;
  const Vector3d& along = axes_[1].direction;
  const Vector3d elbow = axes_[2].point - axes_[1].point;
  const Vector3d forearm = wrist_ - axes_[2].point;
  // Joints 2 and 3 move the wrist's centre across their axes alone.
  for (const double back :
       turns_to(axes_[0].direction, along, from_first, along.dot(wrist_ - axes_[0].point))) {
    const Vector3d reach =
        axes_[0].point + rotation(axes_[0].direction, back) * from_first - axes_[1].point;
    const double stretch = (reach.squaredNorm() - elbow.squaredNorm() - forearm.squaredNorm()) / 2;
    for (const double third : turns_to(axes_[2].direction, elbow, forearm, stretch)) {
      Angles angles{};
      angles[0] = wrap(-back);
      angles[2] = wrap(third);
      angles[1] = turn_from(along, elbow + rotation(axes_[2].direction, third) * forearm, reach);
      const Matrix3d wrist = (rotation(axes_[0].direction, angles[0]) * rotation(along, angles[1]) *
                              rotation(axes_[2].direction, angles[2]))
                                 .transpose() *
                             moved.linear();
      const Vector3d hand = wrist * axes_[5].direction;
      for (const double fifth : turns_to(axes_[4].direction, axes_[3].direction, axes_[5].direction,
                                         axes_[3].direction.dot(hand))) {
        const Matrix3d bent = rotation(axes_[4].direction, fifth);
        angles[4] = wrap(fifth);
        angles[3] = turn_from(axes_[3].direction, bent * axes_[5].direction, hand);
        const Matrix3d last = (rotation(axes_[3].direction, angles[3]) * bent).transpose() * wrist;
        const Vector3d aside = axes_[5].direction.unitOrthogonal();
        angles[5] = turn_from(axes_[5].direction, aside, last * aside);
        if (this->posture(angles) == posture) return angles;
      }
    }
  }
  return std::nullopt;
}

double WristArm::from_singular_rad(const Angles& angles) const {
  const Vector3d hand = rotation(axes_[4].direction, angles[4]) * axes_[5].direction;
  const double across = axes_[3].direction.cross(hand).norm();
  return std::atan2(across, std::abs(axes_[3].direction.dot(hand)));
}

}  // namespace identify
