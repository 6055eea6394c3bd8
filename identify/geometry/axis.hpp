#pragma once

#include <string_view>

#include <Eigen/Core>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

/// A joint axis in the measurement frame, with its uncertainty. Of a linear joint only the
/// direction is identified: its place is by convention (see placed_axes.hpp).
struct Axis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();    ///< where the covariance holds
  /// Of (direction, point), first order. Zero: known exactly.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  bool linear = false;  ///< the joint moves along it and does not turn

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
/// their directions are alike, within a degree or three standard uncertainties, and the first is a
/// linear joint's, or the place of their common normal is uncertain by more than 2 % of `size_mm`
/// (the arm's) or beyond twice that; they meet when their distance is below three standard
/// uncertainties. It is unknown where the directions together are uncertain by 0.25 rad or more.
[[nodiscard]] Relation relation_between(const Axis& first, const Axis& second, double size_mm);

}  // namespace identify
