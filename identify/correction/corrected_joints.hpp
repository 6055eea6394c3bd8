#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "identify/poses/arm_fit.hpp"
#include "identify/poses/pose_fit.hpp"

namespace identify {

/// Joints with which an identified arm puts its tool where the controller believes it to be. All
/// angles are the controller's, rad.
class CorrectedJoints {
 public:
  /// `identified`: model, noise and covariance. `controller`: the specified arm with the base and
  /// the targets that fit it best: where it has the tool is where the tool is wanted. `tool`: the
  /// tool in the frame after the last row. It moves with the measured target nearest to it; what
  /// positions do not tell of the last frame, its turn about the last axis, stays as specified.
  CorrectedJoints(const PoseFit& identified, const PlacedArm& controller,
                  const Eigen::Isometry3d& tool);

  struct Reached {
    std::vector<double> angles_rad;
    bool converged = false;
    /// What the tool's position is expected to be off by (root mean square): what the identified
    /// model does not know, and the noise of one pose.
    double expected_mm = 0;
  };

  /// Where the controller believes the tool to be, in the measurement frame.
  [[nodiscard]] Eigen::Isometry3d believed(const std::vector<double>& angles_rad) const;
  /// Where the identified arm has it.
  [[nodiscard]] Eigen::Isometry3d identified(const std::vector<double>& angles_rad) const;
  /// For where the controller believes the tool to be with `angles_rad`; near these. Arms of six
  /// joints and more; of more, the least motion.
  [[nodiscard]] Reached reach(const std::vector<double>& angles_rad) const;
  /// How far the tool is from the measured target that it moves with.
  [[nodiscard]] double from_target_mm() const { return from_target_mm_; }

 private:
  [[nodiscard]] Pose pose_at(const std::vector<double>& angles_rad) const;

  PoseFit fit_;  ///< its chain's tool is the tool; target 0 its point
  PlacedArm controller_;
  Eigen::Isometry3d tool_;
  double from_target_mm_ = 0;
};

}  // namespace identify
