#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/dh_extraction.hpp"

namespace identify {

/// A table's Z axes, those of linear joints in the place that convention gives them.
struct PlacedAxes {
  std::vector<std::optional<Axis>> z;
  Eigen::MatrixXd covariance;  ///< of all (direction, point), six rows an axis
  /// How these change with what was given: as many columns, and three of the target.
  Eigen::MatrixXd by_given;
};

/// Gives the axes of linear joints a place, for which of a linear joint's displacement nothing
/// tells. As Hayati & Mirmirani (J. Robotic Systems 2, 1985) have it, the axis passes through the
/// origin of the next frame: a of the row and b of the next are zero; with a specified table they
/// are as specified. The next frame's origin is the foot of the common normal on the next axis, or,
/// where that is parallel to the one after it, level with the origin of the frame after it. Where
/// nothing of the arm tells (the last axis; parallel ones up to the last), the target takes the
/// origin's place. Beside a parallel axis a linear joint's lies on it.
///
/// `z`: one a joint, as the table has them; places of linear ones are not looked at. `covariance`:
/// of their (direction, point), six rows an axis, and of the target, three rows. `specified`: empty
/// or one row an axis.
[[nodiscard]] PlacedAxes placed(std::vector<std::optional<Axis>> z,
                                const Eigen::Vector3d& target_mm, const Eigen::MatrixXd& covariance,
                                const std::vector<DhRow>& specified, double size_mm);

/// The DH table of Z axes whose errors are independent, those of linear joints in their place; for
/// the target stands where the first linear joint's axis was found.
[[nodiscard]] std::vector<DhEstimate> placed_table(const std::vector<std::optional<Axis>>& z,
                                                   const std::vector<DhRow>& specified,
                                                   double size_mm);

[[nodiscard]] bool any_linear(const std::vector<std::optional<Axis>>& axes);

/// Takes numbers that change with the target's place, `by_target` (how the axes change with it),
/// for what they are: by convention. Those of an arm that only turns do not.
void leave_to_target(std::vector<DhEstimate>& table, const std::vector<std::optional<Axis>>& z,
                     const Eigen::MatrixXd& by_target, const std::vector<DhRow>& specified,
                     double size_mm);

}  // namespace identify
