#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "identify/sweeps/sample.hpp"

namespace identify {

/// Where a target was while the arm stood still.
struct Pose {
  Sample sample;  ///< with a position and all of the arm's angles
  std::size_t target = 0;
  std::string name;  ///< for people: as in "poses.csv, line 17"
};

}  // namespace identify
