#pragma once

#include <vector>

#include "identify/identification.hpp"

namespace identify {

/// Where the first axes are parallel, in a device's frame or behind a joint without an axis: that
/// nothing tells where along them the arm stands, at which height the numbers are stated, and which
/// are by convention for it. `measured` is the table of `found` before that convention.
[[nodiscard]] std::vector<Warning> advice_on_height(const Identification& found,
                                                    const std::vector<DhEstimate>& measured,
                                                    const Campaign& campaign);

}  // namespace identify
