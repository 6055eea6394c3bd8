#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "identify/poses/arm_fit.hpp"
#include "identify/poses/arm_reach.hpp"
#include "identify/poses/pose_fit.hpp"

namespace identify {

/// Where an arm's target stands off where its specification has it.
struct DisplacedPoint {
  Eigen::Vector3d at_mm;  ///< as specified, in the robot's base
  Eigen::Vector3d by_mm;  ///< identified less specified, in the robot's base
  double band_mm = 0;     ///< half the 95 % band of the size of that, to first order
};

/// A plane across one of the base's axes.
struct DisplacementSlice {
  std::size_t across = 0;  ///< 0, 1, 2: X, Y, Z
  double at_mm = 0;
  std::vector<DisplacedPoint> points;
};

/// Over the workspace, what separates an identified arm from its specification once base and tool
/// are fitted: what those can take up is no displacement.
struct DisplacementMap {
  double step_mm = 0;                       ///< between points of the grid; slices have half of it
  std::vector<DisplacedPoint> grid;         ///< those that can be reached
  std::array<DisplacementSlice, 3> slices;  ///< across X, Y, Z, through the target at home
};

/// `identified`: model and covariance of a fit of poses; `specified`: the arm as specified, placed
/// in the same frame. For the first target, at the angles that ArmReach finds by `specified`. Base
/// and tool are fitted at the points of the grid. Deterministic.
[[nodiscard]] DisplacementMap displacement_map(const PoseFit& identified,
                                               const PlacedArm& specified,
                                               const JointRanges& ranges);

}  // namespace identify
