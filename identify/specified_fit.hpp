#pragma once

#include <optional>

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"

namespace identify {

/// A built robot is never so far off what its maker specifies. Lengths, in mm or as a share of the
/// arm's (the sum of all its lengths), whichever is more; twists; and thetas, which mastering
/// shifts. Castings and machining miss by a millimetre and some hundredths of a degree, mastering
/// by a degree.
inline constexpr double kMostOff_mm = 8;
inline constexpr double kMostOffShare = 0.004;
inline constexpr double kMostTwist_rad = 1 * kDegree;
inline constexpr double kMostOff_rad = 5 * kDegree;

/// What `found.dh` says against the specified table, beyond what a built robot can be off, and if
/// one is found, the mistake that explains it: positions in another unit, a mirrored frame,
/// radians, a joint's angles negated, two joints exchanged. Where the robot's base stands is not
/// judged. Without a specified table, positions of no robot's size. Nothing where nothing is wrong.
[[nodiscard]] std::optional<Warning> contradiction_of_specified(const Identification& found,
                                                                const Campaign& campaign);

}  // namespace identify
