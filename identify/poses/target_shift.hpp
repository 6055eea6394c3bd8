#pragma once

#include <cstddef>
#include <vector>

#include "identify/poses/pose_estimate.hpp"

namespace identify {

/// The shift of a target from one pose of the order on that explains most.
struct TargetShift {
  double square = 0;  ///< chi-square
  std::size_t from = 0;
  double size_mm = 0;
  std::size_t at = 0;  ///< of the target's poses
};

/// Of targets that were moved on the tool: beyond chance, and by no less than what is left of a
/// pose. By medians: poses that lie far off matter little, and so many may have been moved that
/// they do not count in the fit.
[[nodiscard]] std::vector<TargetShift> target_shifts(const PoseEstimate& found,
                                                     const std::vector<Pose>& poses);

}  // namespace identify
