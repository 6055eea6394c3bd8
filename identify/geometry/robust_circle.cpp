#include "identify/geometry/robust_circle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Geometry>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Half of them bad, one of so many triples is all good but for once in 10^8 times.
constexpr int kTriples = 150;
/// Medians of more points than these would not choose better.
constexpr Index kJudges = 400;
/// So few tell what is hopeless, by their nearest quarter: half of them may be bad.
constexpr Index kFirstJudges = 40;

std::optional<CircleFit> circle_through(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d u = b - a;
  const Vector3d v = c - a;
  const Vector3d w = u.cross(v);
  const double squared = w.squaredNorm();
  if (!(squared > 1e-12 * u.squaredNorm() * v.squaredNorm())) return std::nullopt;
  CircleFit circle;
  const Vector3d to_center =
      (u.squaredNorm() * v.cross(w) + v.squaredNorm() * w.cross(u)) / (2 * squared);
  circle.center_mm = a + to_center;
  circle.normal = w / std::sqrt(squared);
  circle.radius_mm = to_center.norm();
  return circle;
}

double squared_distance(const CircleFit& circle, const Vector3d& point) {
  const CircleResidual off = residual(circle, point);
  return off.plane_mm * off.plane_mm + off.radial_mm * off.radial_mm;
}

/// The squared distance that a share of so many of the points has at most.
double squared_within(double share, const CircleFit& circle, const Matrix3Xd& points, Index judges,
                      std::vector<double>& room) {
  room.clear();
  const Index step = std::max<Index>(1, points.cols() / judges);
  for (Index i = 0; i < points.cols(); i += step)
    room.push_back(squared_distance(circle, points.col(i)));
  const auto place =
      room.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(room.size()));
  std::nth_element(room.begin(), place, room.end());
  return *place;
}

double median_squared(const CircleFit& circle, const Matrix3Xd& points, std::vector<double>& room) {
  return squared_within(0.5, circle, points, kJudges, room);
}

}  // namespace

std::optional<CircleFit> fit_robust_circle(const Matrix3Xd& points) {
  if (points.cols() < 4 || !points.allFinite()) return std::nullopt;
  std::mt19937 random(1);
  // Without std::uniform_int_distribution, whose numbers differ from library to library.
  const auto third = [&](Index part) {
    const Index from = part * points.cols() / 3;
    const Index count = std::max<Index>(1, (part + 1) * points.cols() / 3 - from);
    return points.col(from + static_cast<Index>(random() % static_cast<std::uint32_t>(count)));
  };
  std::vector<double> room;
  std::optional<CircleFit> best;
  double least = std::numeric_limits<double>::infinity();
  for (int triple = 0; triple < kTriples; ++triple) {
    const Vector3d a = third(0), b = third(1), c = third(2);
    const auto circle = circle_through(a, b, c);
    if (!circle || squared_within(0.25, *circle, points, kFirstJudges, room) > least) continue;
    if (const double median = median_squared(*circle, points, room); median < least) {
      least = median;
      best = circle;
    }
  }
  if (!best) return std::nullopt;
  // A median of chi squared with two degrees of freedom is 1.386; the circle through three points
  // is itself off, so be generous. Twice, since the second circle is much better than the first.
  for (int round = 0; round < 2; ++round) {
    const double bound = 36 * median_squared(*best, points, room) / 1.386;
    Matrix3Xd close(3, points.cols());
    Index count = 0;
    for (Index i = 0; i < points.cols(); ++i)
      if (squared_distance(*best, points.col(i)) <= bound) close.col(count++) = points.col(i);
    const auto refined = fit_circle(close.leftCols(count));
    if (!refined) break;
    best = refined;
  }
  return best->points > 0 ? best : fit_circle(points);
}

}  // namespace identify
