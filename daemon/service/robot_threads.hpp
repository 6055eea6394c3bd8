#pragma once

#include "daemon/system/turn_threads.hpp"

namespace sweepd {

/// What the robots of this program share. A reply thread is each robot's own.
struct RobotThreads {
  TurnThreads acquisition{"acquisition"};  ///< a lane a processor
  TurnThreads recorders{"recorder"};       ///< a lane a file system, see file_system_of()
};

}  // namespace sweepd
