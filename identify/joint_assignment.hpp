#pragma once

#include <vector>

#include "identify/sweep.hpp"

namespace identify {

/// A joint's turn in a campaign, as declared by a sweep plan.
struct DeclaredJoint {
  std::size_t joint = 0;  ///< counted from 0
  /// Of the first stroke, positioning included: +1 where the angle rises, -1 where it falls.
  int first_direction = 0;  ///< 0: unknown; the first stroke's is then taken as +1
};

/// Tells the joint of each stroke where no angles do: consecutive arcs about the same axis belong
/// to the same joint, and the joints come in the declared order. Strokes with a defect are passed
/// over. Sets `joint` and `direction`; arcs beyond the declared order stay without a joint. Returns
/// how many groups of arcs were found.
std::size_t assign_joints(std::vector<Sweep>& strokes, const std::vector<DeclaredJoint>& order);

}  // namespace identify
