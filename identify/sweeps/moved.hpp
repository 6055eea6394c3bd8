#pragma once

namespace identify {

// Positions that move by less than any sweep, and yet by far more than they scatter, are in another
// unit than their name says.

inline constexpr double kSmallestMove_mm = 10;
/// In sizes of what positions scatter by: rests move by less.
inline constexpr double kMovedSizes = 100;

}  // namespace identify
