#pragma once

#include <vector>

#include "identify/dh/dh_extraction.hpp"
#include "tests/identify/simulated_campaign.hpp"

namespace sweepd::test {

/// The joint axes of an arm at its home as lines, known exactly, about +Z of the table's frames.
inline std::vector<identify::Axis> axes_of(const identify::Arm& arm) {
  std::vector<identify::Axis> axes;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (const auto& row : arm.rows) {
    identify::Axis axis;
    axis.direction = frame.linear().col(2);
    axis.point_mm = frame.translation();
    axes.push_back(axis);
    frame = frame * identify::transform(row);
  }
  return axes;
}

}  // namespace sweepd::test
