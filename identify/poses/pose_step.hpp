#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "identify/poses/pose_fit.hpp"

namespace identify {

/// Whether something was moved amid the poses: from one of them on the device or the robot's base
/// stands elsewhere, or a target on the tool, or a joint stands off what its angle says.
///
/// A score test for each place in their order (Rao, Proc. Camb. Phil. Soc. 44, 1948): with B the
/// columns of what was moved, at the poses from there on, g = sum of B' V^-1 r has the covariance
/// M = sum of B' V^-1 B - N_B N^-1 N_B' where nothing was moved, with N the information of all
/// poses and N_B that of both. M^-1 g is how far it was moved.
struct PoseStep {
  enum class Of { device, target, joint };
  Of of = Of::device;
  std::size_t which = 0;   ///< target or joint
  std::size_t from = 0;    ///< the first pose after it
  double chi_squared = 0;  ///< g' M^-1 g, the largest of all places
  /// Root mean square over the poses from there on of how far positions lie elsewhere, less what
  /// noise makes of it.
  double moved_mm = 0;
  double turned = 0;  ///< of a joint, by how much it stands farther than told, in rad (linear: mm)
  /// By how much it has the fit's fixed parameters off.
  Eigen::VectorXd bias;
  bool seen = false;    ///< by chance in one of a thousand files, if the noise is as the fit has it
  bool sudden = false;  ///< a move at one place explains more than any smooth motion
};

/// Nothing is seen in the first and the last few poses.
[[nodiscard]] PoseStep step_in(const PoseFit& fit, const std::vector<Pose>& poses);

}  // namespace identify
