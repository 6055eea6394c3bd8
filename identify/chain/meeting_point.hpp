#pragma once

#include <vector>

#include "identify/chain/chain.hpp"

namespace identify {

/// A circle by its axis and one point on it; of a linear joint the line through that point.
struct AxisCircle {
  ChainAxis axis;
  Eigen::Vector3d on_it_mm;

  /// From the axis to a point, across.
  [[nodiscard]] Eigen::Vector3d arm(const Eigen::Vector3d& point) const;
  /// From a point to the circle.
  [[nodiscard]] Eigen::Vector3d to_circle(const Eigen::Vector3d& point) const;
};

/// Sum of squared distances.
[[nodiscard]] double misfit(const std::vector<AxisCircle>& circles, const Eigen::Vector3d& point);

/// The point closest to all circles, by Gauss-Newton from `start`; without one, from all around the
/// first circle, for others may pass near it more than once. A single circle is met anywhere on it.
[[nodiscard]] Eigen::Vector3d meeting_point(const std::vector<AxisCircle>& circles,
                                            Eigen::Vector3d start);
[[nodiscard]] Eigen::Vector3d meeting_point(const std::vector<AxisCircle>& circles);

}  // namespace identify
