#pragma once

#include "identify/identification.hpp"

namespace identify {

/// All joints at home, the target is on all circles. Appends to `found.doubts`:
///   off_home, where one joint's circle passes by where the others' meet;
///   device_moved, where from one sweep on the circles meet at another place, and before and after
///   it each at one; off_home, where the sweeps on one side of that are of one joint alone. Circles
///   of two joints always meet: where few ran before or after, the step may have been a sweep later
///   or earlier;
///   off_home, where a joint's angles, as told while it swept, are off those at which the target
///   was seen by more than gears err, and the other joints' angles are not; off_home, where the
///   chain finds the target millimetres off home.
/// The first of these that holds. A move that the chain allows for is a warning.
/// `timed`: samples tell when they were taken, in s.
void judge_home(Identification& found, bool timed);

}  // namespace identify
