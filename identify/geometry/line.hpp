#pragma once

#include <Eigen/Core>

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
/// continuously but for one turn-over.
[[nodiscard]] Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& direction);

}  // namespace identify
