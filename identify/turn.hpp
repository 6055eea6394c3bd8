#pragma once

#include <optional>
#include <vector>

#include "identify/axis.hpp"
#include "identify/sweep.hpp"

namespace identify {

/// Strokes about one axis: those of one joint, no angle telling of which.
struct Turn {
  std::vector<std::size_t> strokes;  ///< places in the list that was searched
  std::vector<double> angles_rad;    ///< one a stroke, positive about the axis
  Axis axis;                         ///< its sense of rotation is any
};

/// Groups strokes without a defect: those whose points lie on one circle are of one turn, though
/// others came between. Turns in the order in which they began. Of `strokes` those count whose
/// place is in `places`.
[[nodiscard]] std::vector<Turn> turns_in(const std::vector<Sweep>& strokes,
                                         const std::vector<std::size_t>& places);

}  // namespace identify
