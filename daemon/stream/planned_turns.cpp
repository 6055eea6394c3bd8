#include "daemon/stream/planned_turns.hpp"

#include "identify/sweeps/turn.hpp"

namespace sweepd {

std::optional<std::size_t> PlannedTurns::joint_of(const identify::Sweep& stroke) {
  if (order_.empty() || stroke.defect != identify::SweepDefect::none) return std::nullopt;
  if (last_ && identify::turns_in({*last_, stroke}, {0, 1}, 2).size() > 1) ++turn_;
  last_ = stroke;
  return order_[turn_ % order_.size()].joint;
}

}  // namespace sweepd
