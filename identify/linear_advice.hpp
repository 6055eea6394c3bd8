#pragma once

#include <vector>

#include "identify/identification.hpp"

namespace identify {

/// What to do about a linear joint's strokes, in mm where advice about others is in angles: codes
/// and texts as of `add_advice`.
[[nodiscard]] std::vector<Warning> advice_of_linear(const Identification& found, std::size_t joint,
                                                    const Resolution& resolution);

/// Adds to the doubts where a linear joint's strokes contradict themselves: they run along
/// different lines, on no straight line, or by another way than was told.
void judge_linear_joints(Identification& found);

}  // namespace identify
