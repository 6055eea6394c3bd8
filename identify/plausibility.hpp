#pragma once

#include "identify/identification.hpp"

namespace identify {

/// Appends to `found.doubts` what in the data contradicts itself or what a built robot can be:
///   external_axis_moved, duplicate_sweep, strokes_disagree, circle_misfit, angle_arc_mismatch,
///   off_home, unit_factor, frame_mirrored, joints_exchanged, specified_contradicted.
/// Every threshold is far beyond what noise, gears, load, drift and delay do: a doubt is no measure
/// of accuracy.
void judge_plausibility(Identification& found, const Campaign& campaign);

}  // namespace identify
