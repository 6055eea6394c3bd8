#pragma once

#include <optional>

#include "identify/circle/circle_estimate.hpp"
#include "identify/geometry/circle_fit.hpp"

namespace identify {

/// A joint's circle that outliers have not spoiled.
struct SeenCircle {
  CircleFit circle;
  double usual_mm = 0;  ///< distance of the middle one of its points
  /// Of the middle ones of its arc's sections, root mean square; nothing where points are too few
  /// for it.
  std::optional<double> bent_mm;
};

/// Nothing where the joint has no circle.
[[nodiscard]] std::optional<SeenCircle> seen_circle(const JointResult& joint);

}  // namespace identify
