#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "identify/sweep.hpp"
#include "identify/warning.hpp"

namespace identify {

struct Campaign;

/// A joint's turn in a campaign, as declared by a sweep plan.
struct DeclaredJoint {
  std::size_t joint = 0;  ///< counted from 0
  /// Of the first stroke, positioning included: +1 where the angle rises, -1 where it falls.
  int first_direction = 0;  ///< 0: unknown; the first stroke's is then taken as +1
  /// Every stroke of the turn, ways from and to home included: positive where the angle rises.
  /// Empty: not known.
  std::vector<double> strokes_rad = {};
};

/// How sure it is whose strokes are whose.
struct JointAssignment {
  bool senses_known = true;  ///< `direction` of the strokes is the controller's
  /// What was seen does not contradict `Campaign::declared_home_rad`.
  bool home_holds = true;
  std::string doubt;  ///< why the order is not certain; empty where it is
  std::vector<Warning> warnings;
};

/// Tells the joints of strokes that have none. Arcs about one axis belong to one joint. Which joint
/// that is, the axes' geometry says against the specified table, at the declared home, at that of
/// the table or at any, under every order; where several orders agree, the plan's strokes do. Where
/// neither confirms an order, the declared one is assumed, or joint 1 to n, and a doubt remains.
///
/// Each target by itself. Sets `joint` and `direction`; strokes with a defect, and arcs beyond the
/// number of joints, stay without a joint.
[[nodiscard]] JointAssignment assign_joints(std::vector<Sweep>& strokes, const Campaign& campaign);

}  // namespace identify
