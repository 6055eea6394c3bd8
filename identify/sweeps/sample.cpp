#include "identify/sweeps/sample.hpp"

namespace identify {

// Not in the header: where identify was built before, without ThreadSanitizer, what it reads of
// samples that threads share would be seen, and not that it lets go of them.
Eigen::Matrix3Xd positions(const std::vector<Sample>& samples) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(samples.size()));
  Eigen::Index count = 0;
  for (const Sample& sample : samples)
    if (sample.has_position) points.col(count++) = sample.position_mm;
  points.conservativeResize(3, count);
  return points;
}

}  // namespace identify
