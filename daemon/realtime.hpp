#pragma once

#include <string>
#include <vector>

#include "daemon/settings.hpp"

namespace sweepd {

/// What the system granted, read back from it, and what it refused.
struct RealTimeReport {
  std::vector<std::string> granted;  ///< "SCHED_FIFO 80", "processors 2, 3", "memory locked"
  std::vector<std::string> refused;  ///< what, why, and what to do: a sentence each
};

/// Keeps the memory of the process in memory, each page from its first use on. Not tried where the
/// limit of locked memory would make later allocations fail.
void lock_memory(RealTimeReport& report);

/// Puts the calling thread on its processors and under SCHED_FIFO, and touches its stack.
void enter_real_time(const RealTimeSettings& settings, RealTimeReport& report);

/// The calling thread, and those that it starts from now on, keep off these processors. Most
/// kernels do not interrupt themselves, not even for SCHED_FIFO: a disk's work for one thread would
/// delay the reply of another on the same processor. Nothing happens if no processor would be left.
void leave_processors(const std::vector<int>& cpus) noexcept;

/// Names the calling thread for `top -H` and debuggers; 15 letters at most.
void name_thread(const char* name) noexcept;

/// The calling thread lets all others go first, at once (SCHED_IDLE): work that can wait must not
/// meet a reply. A lower priority alone let a reply without SCHED_FIFO wait for a time slice of 4
/// ms.
void yield_to_others() noexcept;

}  // namespace sweepd
