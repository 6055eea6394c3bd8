#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "identify/geometry/angle.hpp"

namespace identify {

/// An axis as a unit dual vector n + eps (c x n): unit direction and moment about the origin.
struct Line {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d moment_mm = Eigen::Vector3d::Zero();

  /// The line through `point_mm` along `direction`, which need not be of unit length.
  [[nodiscard]] static Line through(const Eigen::Vector3d& point_mm,
                                    const Eigen::Vector3d& direction);

  /// The point of the line closest to the origin.
  [[nodiscard]] Eigen::Vector3d point_mm() const;
  /// The point of the line closest to `from_mm`.
  [[nodiscard]] Eigen::Vector3d closest_mm(const Eigen::Vector3d& from_mm) const;
  [[nodiscard]] Line reversed() const { return {-direction, -moment_mm}; }
};

/// A target that is closer to an axis tells little of where that points.
inline constexpr double kNearAxis_mm = 20;

/// Between any two of these places, and 1 mm at least.
[[nodiscard]] double largest_distance_mm(const std::vector<Eigen::Vector3d>& places_mm);

/// A dual number: real + eps dual.
struct DualNumber {
  double real = 0;
  double dual = 0;
};

/// n1 . n2 = cos(alpha + eps a) = cos(alpha) - eps a sin(alpha), with a along n1 x n2.
[[nodiscard]] DualNumber dot(const Line& first, const Line& second);

/// How a second line lies to a first. For parallel lines the common normal is anywhere: the feet
/// are not finite then, and the caller has to ask `sine` first.
struct LinePair {
  double angle_rad = 0;    ///< between the directions, 0 to pi
  double sine = 0;         ///< of that angle
  double distance_mm = 0;  ///< along first x second: signed; not negative for parallel lines
  Eigen::Vector3d cross = Eigen::Vector3d::Zero();          ///< first x second, of length `sine`
  Eigen::Vector3d first_foot_mm = Eigen::Vector3d::Zero();  ///< of the common normal, on the first
  Eigen::Vector3d second_foot_mm = Eigen::Vector3d::Zero();
};

/// The angle is atan2(|n1 x n2|, n1 . n2), never acos, which loses small angles. Feet:
/// t1 = det[d, n2, w]/|w|^2, t2 = det[d, n1, w]/|w|^2 with d = c2 - c1, w = n1 x n2.
[[nodiscard]] LinePair relate(const Line& first, const Line& second);

/// Two directions across an axis, unit, right-handed with it. They change with the direction
/// continuously but where its x is 0.8 or -0.8: near Z, as most first axes are, they stay.
[[nodiscard]] Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& direction);

/// [v]x: its product with w is v x w.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// A joint axis in the measurement frame, with its uncertainty. Of a linear joint only the
/// direction is identified: its place is by convention (see placed_axes.hpp).
struct Axis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();    ///< where the covariance holds
  /// Of (direction, point), first order. Zero: known exactly.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  bool linear = false;  ///< the joint moves along it and does not turn
  /// It is the first one, and nothing tells where across it the base's X points.
  bool x_is_free = false;

  [[nodiscard]] Line line() const { return Line::through(point_mm, direction); }
  [[nodiscard]] Axis reversed() const;
  [[nodiscard]] double direction_sigma_rad() const;  ///< in its worst direction
  [[nodiscard]] double point_sigma_mm() const;       ///< across the axis, in its worst direction
};

/// An axis whose direction is less certain than this is none.
inline constexpr double kWorstDirection_rad = 1 * kDegree;
/// What counts as zero for axes without uncertainty, relative.
inline constexpr double kExact = 1e-9;

/// How an axis lies to the next one.
enum class Relation { skew, parallel, intersecting, coincident, last, unknown };
[[nodiscard]] std::string_view text(Relation relation) noexcept;

/// A relation is decided by what the axes' uncertainty allows to say. Two axes are parallel when
/// their directions are alike, within a degree or three standard uncertainties, and one is a linear
/// joint's, or the place of their common normal is uncertain by more than 2 % of `size_mm`
/// (the arm's) or beyond twice that; they meet when their distance is below three standard
/// uncertainties. It is unknown where the directions together are uncertain by 0.25 rad or more.
[[nodiscard]] Relation relation_between(const Axis& first, const Axis& second, double size_mm);

}  // namespace identify
