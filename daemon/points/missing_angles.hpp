#pragma once

#include <optional>

#include "daemon/points/points_file.hpp"
#include "identify/geometry/warning.hpp"

namespace sweepd {

/// Of how many points the file tells a position and not all angles; nothing where of none.
[[nodiscard]] std::optional<identify::Warning> missing_angles(const PointsFile& file);

}  // namespace sweepd
