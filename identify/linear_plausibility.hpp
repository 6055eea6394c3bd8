#pragma once

#include "identify/identification.hpp"

namespace identify {

/// Adds to the doubts where a linear joint's strokes contradict themselves: they run along
/// different lines, on no straight line, or by another way than was told.
void judge_linear_joints(Identification& found);

}  // namespace identify
