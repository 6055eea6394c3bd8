#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identify/dh/dh.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

/// Of an axis that is none of the arm's.
constexpr std::size_t kNoJoint = static_cast<std::size_t>(-1);

/// Whose axis is whose: one entry an axis, in their order.
struct JointOrder {
  std::vector<std::size_t> joints;  ///< counted from 0; kNoJoint: the axis is left out
  std::vector<int> senses;          ///< +1 where positive rotation is about the axis, -1 against it
  double misfit = 0;                ///< chi squared, by how arms are built and axes are known
};

/// What the geometry says of the order in which joints swept.
struct JointOrders {
  /// All that agree with the description, and as well as the best does; best first. Where the arm's
  /// lines alone tell, each has a twin with all senses turned round.
  std::vector<JointOrder> fitting;
  bool undecided = false;  ///< so many agree in part that the search gave up
};

/// Compares axes, each of another joint of `arm`, with the description under every order and all
/// senses of rotation, joints left out included. A misfit counts in units of what the axes'
/// uncertainties and the tolerances of a built arm (2 mm, half a degree) explain.
///
/// With `home_rad`, the angles at which the joints stood (within a degree or two), every two lines
/// and the handedness of every three count, and the thetas of all are about those. Without, only
/// what does not depend on the pose: a and alpha of neighbours, and b. Of linear joints only the
/// direction counts. `count` of the axes are joints', the others are left out. No order fits where
/// `count` is 0, or more than there are axes or joints.
[[nodiscard]] JointOrders orders_that_fit(const std::vector<Axis>& axes, std::size_t count,
                                          const Arm& arm,
                                          const std::optional<std::vector<double>>& home_rad);

/// The same for axes whose joints are known, `joints` (rising), under all senses of rotation.
[[nodiscard]] JointOrders senses_that_fit(const std::vector<Axis>& axes,
                                          const std::vector<std::size_t>& joints, const Arm& arm,
                                          const std::optional<std::vector<double>>& home_rad);

}  // namespace identify
