#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "identify/sweeps/sample.hpp"

namespace identify {

/// Which way each joint last turned before it stood still: 1 where its angle rose, -1 where it
/// fell, 0 where that is not known.
using JointSenses = std::array<std::int8_t, kMostJoints>;

/// Where a target was while the arm stood still.
struct Pose {
  Sample sample;  ///< with a position and all of the arm's angles
  std::size_t target = 0;
  std::string name;  ///< for people: as in "poses.csv, line 17"
  JointSenses senses{};
};

}  // namespace identify
