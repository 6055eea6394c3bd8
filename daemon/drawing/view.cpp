#include "daemon/drawing/view.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

namespace sweepd {
namespace {

/// The eye is so many radii away: far enough that nothing is distorted.
constexpr double kEye = 5;

}  // namespace

View View::top() {
  return {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
}
View View::front() {
  return {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()};
}
View View::side() {
  return {Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
}
View View::oblique() {
  const Eigen::Vector3d towards = Eigen::Vector3d(0.75, -1, 0.55).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(towards).normalized();
  return {right, towards.cross(right)};
}
View View::nearly_flat() {
  const Eigen::Vector3d towards = Eigen::Vector3d(0.3, -0.45, 1).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(towards).normalized();
  return {right, towards.cross(right)};
}
View View::perspective(const Eigen::Vector3d& middle, double radius) {
  View view = oblique();
  view.middle_ = middle;
  view.distance_ = kEye * std::max(radius, 1e-9);
  return view;
}

Eigen::Vector2d View::seen(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d from_middle = point - middle_;
  Eigen::Vector2d place(right_.dot(from_middle), up_.dot(from_middle));
  if (distance_ > 0) {
    const double depth = distance_ - right_.cross(up_).dot(from_middle);
    place *= distance_ / std::max(depth, 0.1 * distance_);
  }
  return place;
}

void View::fit(std::span<const Eigen::Vector3d> points, const Frame& frame) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const auto& point : points) {
    if (!point.allFinite()) continue;
    low = low.cwiseMin(seen(point));
    high = high.cwiseMax(seen(point));
  }
  if (!low.allFinite()) low = high = Eigen::Vector2d::Zero();
  const Eigen::Vector2d size = (high - low).cwiseMax(1e-9);
  scale_ = std::min(frame.width / size.x(), frame.height / size.y());
  const Eigen::Vector2d middle = (low + high) / 2;
  origin_ = frame.middle() - scale_ * Spot(middle.x(), -middle.y());
}

Spot View::spot(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d place = seen(point);
  return origin_ + scale_ * Spot(place.x(), -place.y());
}

std::vector<Spot> View::spots(std::span<const Eigen::Vector3d> points) const {
  std::vector<Spot> all;
  all.reserve(points.size());
  for (const auto& point : points) all.push_back(spot(point));
  return all;
}

Eigen::Vector2d View::place(const Spot& spot) const {
  const Spot from_origin = (spot - origin_) / scale_;
  return {from_origin.x(), -from_origin.y()};
}

void draw_triad(Picture& picture, const View& view, const Spot& corner) {
  constexpr double kLength = 26;
  const Spot origin = view.spot(Eigen::Vector3d::Zero());
  for (int axis = 0; axis < 3; ++axis) {
    const Spot way = view.spot(Eigen::Vector3d::Unit(axis) / view.scale()) - origin;
    const Spot tip = corner + kLength * way;
    picture.arrow(corner, tip, "axis");
    picture.words(tip + 8 * way.normalized() + Spot(0, 3), std::string(1, "XYZ"[axis]),
                  Anchor::middle, "small");
  }
}

}  // namespace sweepd
