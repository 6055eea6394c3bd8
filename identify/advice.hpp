#pragma once

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"

namespace identify {

/// An axis whose direction is less certain deserves a warning.
inline constexpr double kPoorDirection_rad = 0.05 * kDegree;

/// Appends to `found.warnings` what the user could do better next time, and what in the data is not
/// as the method assumes: each with figures, and where it can be predicted, with what the remedy
/// would give. By the final axes and their covariance, and by what the chain saw of the noise.
void add_advice(Identification& found, const Campaign& campaign);

/// Leaves out warnings that follow from what a doubt says: they would have the user measure again
/// what was only told wrongly, or warm up what was moved.
void leave_out_consequences(Identification& found);

}  // namespace identify
