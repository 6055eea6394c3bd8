#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "identify/sweeps/sweep.hpp"

namespace identify {

/// Strokes about one axis: of some points each, without strays.
struct StrokeGroup {
  std::vector<std::size_t> strokes;      ///< their places
  std::vector<Eigen::Matrix3Xd> points;  ///< one a stroke
  Eigen::Matrix3Xd all = Eigen::Matrix3Xd(3, 0);
  double misfit_mm = 0;  ///< of the circle through all
};

/// The groups of strokes that turns_in() makes turns of.
[[nodiscard]] std::vector<StrokeGroup> stroke_groups(const std::vector<Sweep>& strokes,
                                                     const std::vector<std::size_t>& places,
                                                     std::size_t joints);

}  // namespace identify
