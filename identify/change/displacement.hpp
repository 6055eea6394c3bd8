#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "identify/change/compared_arms.hpp"

namespace identify {

/// By how much a tool stands elsewhere with the second of two arms.
struct Displacement {
  double largest_mm = 0;
  /// 95 % band, to first order at the pose of the largest; not below zero.
  double low_mm = 0;
  double high_mm = 0;
  std::vector<double> turns_rad;  ///< that pose, from the first arm's home
};

/// How far each joint may turn from home, rad; a linear one as everywhere in here.
using TurnRange = std::array<double, 2>;

/// Where a tool can be.
struct ToolReach {
  std::vector<bool> linear;       ///< one a joint
  std::vector<TurnRange> ranges;  ///< one a joint
  Eigen::Vector3d tool_mm = Eigen::Vector3d::Zero();
};

/// The largest within the ranges, by a `difference` of the arms' numbers and its covariance, to
/// first order: searched at `poses` that fill the ranges evenly, the same ones in every call, and
/// on from the best of them. Base and tool of the second arm are fitted to the first's at these
/// poses: what they can take up is no displacement. The tool is a point in the frame before the
/// first table's last row.
[[nodiscard]] Displacement largest_displacement(const ComparedArms& arms,
                                                const Eigen::VectorXd& difference,
                                                const Eigen::MatrixXd& covariance,
                                                const ToolReach& reach, std::size_t poses = 2000);

/// The arms' covariances are of first order. Where one joint has swept so little that its axis is
/// known to half a degree, well known combinations of its numbers are off by several uncertainties.
/// This is what the numbers may be off by so: it moves the tool to first order, with base and tool
/// fitted, by as much as the part of their difference that may be chance does to second order.
[[nodiscard]] Eigen::VectorXd second_order(const ComparedArms& arms, const ToolReach& reach);

}  // namespace identify
