#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identify/dh/dh.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

/// What tells which way about its axis a joint's angle rises.
enum class SenseBy {
  nothing,  ///< neither angles nor a plan: the way that it moved first is taken
  plan,     ///< a plan that was declared; people run others
  angles,   ///< its own angles along the positions
};

/// Which way the axes turn, and how sure that is.
struct AxisSenses {
  std::vector<int> senses;             ///< one a joint: +1 as the axis is given, -1 against it
  std::vector<std::size_t> ambiguous;  ///< joints whose other sense agrees as well
  std::vector<std::size_t> against;    ///< joints that turn against their plan
  /// All other senses that agree as well, each one a joint.
  std::vector<std::vector<int>> others;
};

/// Scores all senses together: by the geometry of every two and three axes against the arm (at one
/// of `poses_rad`, angles at which the joints may have stood, the likeliest first; else by what
/// does not depend on the pose), in the robot's own frame by the first axis' direction, and by what
/// is known of each joint. `axes` point along positive rotation as far as that is known. Of senses
/// that agree as well, those with the fewest turns of the outer joints count. Where no senses agree
/// with the arm, all stay as they are given, and none is ambiguous: the arm is another.
[[nodiscard]] AxisSenses senses_of(const std::vector<std::optional<Axis>>& axes,
                                   const std::vector<SenseBy>& known, const Arm& arm,
                                   const std::vector<std::vector<double>>& poses_rad,
                                   bool device_frame);

}  // namespace identify
