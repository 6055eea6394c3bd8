#pragma once

#include "daemon/system/turn_threads.hpp"

namespace sweepd {

/// What the robots of this program share. A reply thread is each robot's own.
struct RobotThreads {
  TurnThreads acquisition{"acquisition"};  ///< a lane a processor
};

}  // namespace sweepd
