#pragma once

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"

namespace identify {

/// Strokes of one joint, seen from one home, differ by what the robot's repeatability allows:
/// hundredths of a millimetre. Uncertainties count ten times, as for errors that are correlated.
inline constexpr double kApart_mm = 5;
inline constexpr double kApart_rad = 1 * kDegree;
inline constexpr double kApartSigmas = 10;
/// Points so far off their circle or line: beyond any device and any rail, whatever the others'
/// are.
inline constexpr double kOffCurve_mm = 10;

/// Appends to `found.doubts` what in the data contradicts itself or what a built robot can be:
///   external_axis_moved, duplicate_sweep, strokes_disagree, circle_misfit, angle_arc_mismatch,
///   joint_along, device_moved, off_home, unit_factor, frame_mirrored, angles_negated,
///   joints_exchanged, specified_contradicted.
/// Every threshold is far beyond what noise, gears, load, drift and delay do: a doubt is no measure
/// of accuracy.
void judge_plausibility(Identification& found, const Campaign& campaign);

}  // namespace identify
