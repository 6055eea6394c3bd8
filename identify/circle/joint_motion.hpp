#pragma once

#include <optional>

#include "identify/circle/circle_estimate.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {

/// How far the middle one of the points is from a circle.
[[nodiscard]] double usual_distance_mm(const CircleFit& circle, const Eigen::Matrix3Xd& points_mm);

/// How the points of a joint's circle lie about it; a few far off do not matter.
struct CircleScatter {
  double usual_mm = 0;  ///< distance of the middle one of its points
  /// Of the middle ones of its arc's sections, root mean square; nothing where points are too few
  /// for it.
  std::optional<double> bent_mm;
};

/// Nothing where the joint has no circle.
[[nodiscard]] std::optional<CircleScatter> circle_scatter(const JointResult& joint);

/// How the target moves in a joint's sweeps.
struct JointMotion {
  double speed_mm_s = 0;
  double step_mm = 0;  ///< from sample to sample
};

/// In the middle of the used sweeps, where the joint is at speed; from samples so far apart that
/// noise does not look like motion. Nothing without such a sweep.
[[nodiscard]] std::optional<JointMotion> joint_motion(const JointResult& joint);

/// What makes a stroke short that was swept: angles that are read in another unit, or that are
/// another joint's.
[[nodiscard]] std::optional<Warning> mistold(const Sweep& sweep);

/// Which sweeps noise may have hidden, wholly or in part, and what to do. Nothing where noise does
/// not set the limit, or all joints were swept clearly faster and have an axis.
[[nodiscard]] std::optional<Warning> hidden_motion(const CircleEstimate& found,
                                                   const MotionLimit& limit);

}  // namespace identify
