#pragma once

#include <algorithm>
#include <atomic>
#include <thread>

#include "daemon/system/turn_threads.hpp"

namespace sweepd {

/// What the robots of this program share. A reply thread is each robot's own.
struct RobotThreads {
  /// One group.
  TurnThreads acquisition{"acquisition", std::max(1U, std::thread::hardware_concurrency()), 1};
  /// A group is a file system, see file_system_of(). One thread does not suffice for many robots:
  /// to sync one file takes about as long as to sync many at once.
  TurnThreads recorders{"recorder", 16, 4};
  /// Robots that stream: what interim results may take is shared by as many.
  std::atomic<int> streaming{0};
};

}  // namespace sweepd
