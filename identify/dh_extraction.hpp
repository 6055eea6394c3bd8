#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "identify/dh.hpp"
#include "identify/line.hpp"

namespace identify {

/// A joint axis in the measurement frame, with its uncertainty.
struct Axis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();    ///< where the covariance holds
  /// Of (direction, point), first order. Zero: known exactly.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  [[nodiscard]] Line line() const { return Line::through(point_mm, direction); }
  [[nodiscard]] Axis reversed() const;
  [[nodiscard]] double direction_sigma_rad() const;  ///< in its worst direction
  [[nodiscard]] double point_sigma_mm() const;       ///< across the axis, in its worst direction
};

/// How an axis lies to the next one.
enum class Relation { skew, parallel, intersecting, coincident, last, unknown };
[[nodiscard]] std::string_view text(Relation relation) noexcept;

/// What is known of a number. Only an identified one comes from the data.
enum class Knowledge { undetermined, by_convention, identified };

struct DhNumber {
  double value = 0;  ///< mm or rad; meaningless when undetermined
  double sigma = 0;  ///< standard uncertainty; zero unless identified
  Knowledge knowledge = Knowledge::undetermined;
};

struct DhEstimate {
  DhNumber b_mm;
  DhNumber theta_rad;
  DhNumber a_mm;
  DhNumber alpha_rad;
  DhNumber beta_rad;  ///< zero by convention unless the axes are parallel or coincident
  Relation relation = Relation::unknown;
};

/// A relation is decided by what the axes' uncertainty allows to say. Two axes are parallel when
/// the place of their common normal along them is uncertain by more than 2 % of `size_mm` (the size
/// of the arm), or lies beyond twice that size; they meet when their distance is below three
/// standard uncertainties.
[[nodiscard]] Relation relation_between(const Axis& first, const Axis& second, double size_mm);

/// Where a table starts: Z along the first axis, origin at its point closest to that of the
/// measurement frame, X as close to that frame's X (or, where that is along the axis, its Y) as it
/// can be.
[[nodiscard]] Eigen::Isometry3d first_frame(const Axis& axis);

/// DH table of the axes in the paper's notation, as the robot stood: one row an axis, in order,
/// from the first axis' `first_frame` on.
///
/// Row n needs a frame on the end-effector: it is zero by convention. For parallel axes b is free
/// and zero by convention, and beta carries what is not quite parallel: the table reproduces the
/// axes whatever their relation is called. For coincident axes all numbers, and the next theta, are
/// by convention: that they coincide is all that is known. Where an axis is missing, the numbers
/// that need it stay undetermined.
///
/// Axes point as they are given. The sign of each common normal is the one that agrees with
/// `specified` (empty or one row an axis); without it a >= 0, and 0 < alpha < pi where a vanishes.
/// Uncertainties are propagated to first order from `covariance`, that of all axes' (direction,
/// point), six rows an axis, missing ones included; without it from the axes' own, as independent.
[[nodiscard]] std::vector<DhEstimate> extract_dh(const std::vector<std::optional<Axis>>& axes,
                                                 double size_mm,
                                                 const std::vector<DhRow>& specified = {},
                                                 const Eigen::MatrixXd& covariance = {});

/// The values of a table as rows; undetermined ones as zero.
[[nodiscard]] std::vector<DhRow> values(const std::vector<DhEstimate>& table);

/// An angle brought to (-pi, pi].
[[nodiscard]] double wrapped(double angle_rad);

}  // namespace identify
