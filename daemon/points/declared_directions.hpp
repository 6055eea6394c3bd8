#pragma once

#include <vector>

#include "daemon/settings/sweep_plan.hpp"
#include "identify/sweeps/campaign.hpp"
#include "identify/sweeps/sweep.hpp"

namespace sweepd {

/// Sets the direction of sweeps whose joint is known and whose direction is not (no angles), from
/// the plan that was run: the arcs of a joint's strokes, there and back as they were seen, are
/// compared with the plan's sweeps, with these there and back, and with all its strokes, ways from
/// and to home included. Any of these may have been repeated. Where both senses agree, what all
/// joints were measured as counts. Where neither does, or that does not tell, it stays unknown.
void declare_directions(std::vector<identify::Sweep>& sweeps, const SweepPlan& plan,
                        const std::vector<identify::DeclaredJoint>& order);

}  // namespace sweepd
