#pragma once

#include <optional>

#include <Eigen/Core>

#include "identify/circle/circle_estimate.hpp"

namespace identify {

/// Positions of the joint's used sweeps of one target, or of all, in the order of time.
[[nodiscard]] Eigen::Matrix3Xd used_points(const JointResult& joint,
                                           std::optional<std::size_t> target = std::nullopt);

/// The joints' axes by their circles, and of linear joints by their lines, where the direction is
/// certain enough. The noise of a joint's fit counts as no smaller than its neighbours': a target
/// near an axis leaves small residuals and a wrong normal.
void set_circle_axes(CircleEstimate& found, const Resolution& resolution);

/// An upper estimate of the robot's size, for where it matters, by the points.
[[nodiscard]] double size_by_circles_mm(const CircleEstimate& found);

}  // namespace identify
