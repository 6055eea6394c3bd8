#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "identify/geometry/warning.hpp"
#include "identify/sweeps/campaign.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// How sure it is whose strokes are whose.
struct JointAssignment {
  bool senses_known = true;  ///< `direction` of the strokes is the controller's
  /// What was seen does not contradict `Campaign::declared_home_rad`.
  bool home_holds = true;
  std::string doubt;  ///< why the order is not certain; empty where it is
  /// Joints that turned the other way than the plan says, as the description tells.
  std::vector<std::size_t> against_plan;
  std::vector<Warning> warnings;
};

/// Tells the joints of strokes that have none. Arcs about one axis belong to one joint. Which joint
/// that is, the axes' geometry says against the specified table, at the declared home, at that of
/// the table or at any, under every order; where several orders agree, the plan's strokes do. Where
/// neither confirms an order, the plan's is taken, or joint 1 to n, and a doubt remains. Of more
/// arcs than joints those count that agree with table and plan. Where the plan tells, one axis is
/// two joints'.
///
/// Each target by itself. Sets `joint` and `direction`; strokes with a defect, arcs beyond the
/// number of joints, and those of either of two joints, stay without a joint.
[[nodiscard]] JointAssignment assign_joints(std::vector<Sweep>& strokes, const Campaign& campaign);

}  // namespace identify
