#pragma once

#include <optional>

#include "identify/geometry/warning.hpp"
#include "identify/identification.hpp"

namespace identify {

/// Targets of one body stay as far apart as they are. Where pictures of several of them show that
/// from one sweep on a distance is another one, a doubt says which target was moved on the tool, or
/// which two have exchanged their names.
[[nodiscard]] std::optional<Warning> changed_distances(const Identification& found);

}  // namespace identify
