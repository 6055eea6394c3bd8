#pragma once

#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain_estimate.hpp"
#include "identify/poses/pose_fit.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// Where the fit to static poses begins.
struct PoseStart {
  PoseModel model;
  double middle_mm = 0;  ///< distance of the middle pose from where the model has it
};

/// From the chain of sweeps where that is whole, else from the specified table, which is laid to
/// the poses. One of the two is there. `home_rad`: a joint each.
[[nodiscard]] PoseStart pose_start(const std::vector<Pose>& poses, const Campaign& campaign,
                                   const ChainEstimate* sweeps, const std::vector<double>& home_rad,
                                   std::size_t targets);

/// What sweeps tell, in the parameters of a chain with more targets, perhaps: ChainParameters.
struct FromSweeps {
  ChainPrior prior;
  std::vector<ChainEstimate::Part> parts;
};
[[nodiscard]] FromSweeps from_sweeps(const ChainEstimate& sweeps, std::size_t targets);

/// Each of its axes is found.
[[nodiscard]] bool whole(const ChainEstimate* sweeps);

/// From the chain's parameters to (direction, point) of each axis, the targets, and the tool's
/// rotation, as a ChainEstimate's covariance has them.
[[nodiscard]] Eigen::MatrixXd to_estimate(const Chain& chain, bool with_tool);

}  // namespace identify
