#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "identify/sweeps/joint_assignment.hpp"
#include "identify/sweeps/sweep.hpp"

namespace sweepd {

/// Names the joint of each stroke as it happens where no angles tell it: strokes about another axis
/// than the one before are the turn of the plan's next joint. For people who watch; the result
/// looks at the geometry of all strokes, and may find another order. One thread.
class PlannedTurns {
 public:
  /// In the plan's order; empty: nothing is known.
  explicit PlannedTurns(std::vector<identify::DeclaredJoint> order = {})
      : order_(std::move(order)) {}

  /// The joint, counted from 0; nothing where the plan does not tell it, or the stroke has a
  /// defect.
  [[nodiscard]] std::optional<std::size_t> joint_of(const identify::Sweep& stroke);

 private:
  std::vector<identify::DeclaredJoint> order_;
  std::size_t turn_ = 0;
  std::optional<identify::Sweep> last_;
};

}  // namespace sweepd
