#pragma once

#include "identify/identification.hpp"

namespace identify {

/// All joints at home, the target is on all circles. Appends to `found.doubts`:
///   device_moved, where from one sweep on the circles meet at another place, and before and after
///   it each at one;
///   off_home, where one joint's circle passes by where the others' meet, or the chain finds the
///   target millimetres off home.
/// `timed`: samples tell when they were taken, in s.
void judge_home(Identification& found, bool timed);

}  // namespace identify
