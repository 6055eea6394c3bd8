#pragma once

#include <optional>

#include "identify/identification.hpp"

namespace identify {

/// What `found.dh` says against the specified table, beyond what a built robot can be off, and if
/// one is found, the mistake that explains it: positions in another unit, a mirrored frame,
/// radians, a joint's angles negated, two joints exchanged. Where the robot's base stands is not
/// judged. Without a specified table, positions of no robot's size. Nothing where nothing is wrong.
[[nodiscard]] std::optional<Warning> contradiction_of_specified(const Identification& found,
                                                                const Campaign& campaign);

}  // namespace identify
