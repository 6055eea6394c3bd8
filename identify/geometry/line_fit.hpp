#pragma once

#include <optional>

#include <Eigen/Core>

#include "identify/geometry/circle_fit.hpp"

namespace identify {

/// The straight line through the positions of one target point while a linear joint moved.
struct LineFit {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();    ///< centroid of the points
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, from the first to the last point
  double length_mm = 0;      ///< between the points that are furthest apart along it
  double across_rms_mm = 0;  ///< distances of the points from it, in each of two directions
  /// How far the middle of the parabola that fits best stands out over its ends (the sagitta of an
  /// arc), and its standard uncertainty, correlated noise allowed for; infinite where too few
  /// points tell it.
  double bend_mm = 0;
  double bend_sigma_mm = 0;
  std::size_t points = 0;  ///< that lie close enough to count
  double within_mm = 0;    ///< points farther off it are strays
};

/// Least median of squares (Rousseeuw, JASA 79, 1984) over lines through two points, then least
/// squares (the first singular vector) of the points that lie close. Up to nearly half of the
/// points may be anywhere. `points_mm` are columns in the order of the motion. Deterministic.
/// Nothing for fewer than three points, or points in one place.
[[nodiscard]] std::optional<LineFit> fit_line(const Eigen::Matrix3Xd& points_mm);

/// The point's distance from the line along two directions across it, which follow from the line's
/// alone.
[[nodiscard]] Eigen::Vector2d across(const LineFit& line, const Eigen::Vector3d& point_mm);

/// Covariance of (direction, point), first order, for evenly spread points with independent errors
/// of `sigma_mm` across; along the line the point is known exactly.
[[nodiscard]] Matrix6d line_covariance(const LineFit& line, double sigma_mm);

}  // namespace identify
