#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "identify/dh/dh_extraction.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

/// In a device's own frame nothing tells how high the base stands along first axes that are
/// parallel. b of the next row that is not parallel goes along with the height. Other numbers
/// change with it by what the axes are off parallel. The same holds behind a joint without an axis.

/// The Z axes (one a joint), moved as a whole, so that the frame's origin is level with the base.
/// By convention that stands where b of the next row that is not parallel is as specified (zero
/// without a table), and without such a row level with the first axis' point. Axes of which no
/// number hangs on the height come back where they were, bit by bit. X of the base is
/// free.
[[nodiscard]] std::vector<std::optional<Axis>> seen_from_base(std::vector<std::optional<Axis>> z,
                                                              double size_mm,
                                                              const std::vector<DhRow>& specified);

/// Takes numbers that hang on the height for what they are: by convention. That is the b which
/// gives the height; where none does, every number that a metre of height changes by more than its
/// standard uncertainty. `table` is that of `z`, which `seen_from_base` gave.
void leave_to_height(std::vector<DhEstimate>& table, const std::vector<std::optional<Axis>>& z,
                     double size_mm, const std::vector<DhRow>& specified);

/// How much the numbers change with the height, as a sentence without its end: by the least
/// parallel of the axes from that of `row` on, as long as each is parallel to the next.
[[nodiscard]] std::string change_with_height(const std::vector<DhEstimate>& table, std::size_t row);

}  // namespace identify
