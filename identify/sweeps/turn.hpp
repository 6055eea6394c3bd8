#pragma once

#include <optional>
#include <vector>

#include "identify/geometry/line.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// Strokes about one axis: those of one joint, no angle telling of which.
struct Turn {
  std::vector<std::size_t> strokes;  ///< places in the list that was searched
  std::vector<double> angles_rad;    ///< one a stroke, positive about the axis
  Axis axis;                         ///< its sense of rotation is any
};

/// Groups strokes without a defect: those one after the other whose points lie on one circle are of
/// one turn. Where that makes more turns than there are `joints`, those about one axis that others
/// came between are one, too, and no more than twice as many turns are told. (Two joints may have
/// one axis at home: they stay apart as long as there is room.) Turns in the order in which they
/// began. Of `strokes` those count whose place is in `places`.
[[nodiscard]] std::vector<Turn> turns_in(const std::vector<Sweep>& strokes,
                                         const std::vector<std::size_t>& places,
                                         std::size_t joints);

}  // namespace identify
