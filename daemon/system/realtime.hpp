#pragma once

#include <string>
#include <thread>
#include <vector>

namespace sweepd {

/// What is tried so that the reply thread is never kept waiting for a processor or a page of
/// memory.
enum class RealTime {
  require,   ///< without it sweepd does not start
  try_hard,  ///< what is not permitted is said, and done without
  off,
};

struct RealTimeSettings {
  RealTime wish = RealTime::try_hard;
  int priority = 80;      ///< of SCHED_FIFO, 1 to 98
  std::vector<int> cpus;  ///< the reply thread runs on these only; empty: on any
};

/// What the system granted, read back from it, and what it refused.
struct RealTimeReport {
  std::vector<std::string> granted;  ///< "SCHED_FIFO 80", "processors 2, 3", "memory locked"
  std::vector<std::string> refused;  ///< what, why, and what to do: a sentence each
};

/// Keeps the memory of the process in memory, each page from its first use on. Not tried where the
/// limit of locked memory would make later allocations fail.
void lock_memory(RealTimeReport& report);

/// Puts the calling thread on its processors, whatever is wished, as all others keep off them; and
/// under SCHED_FIFO unless that is off. Touches its stack.
void enter_real_time(const RealTimeSettings& settings, RealTimeReport& report);

/// The calling thread, and those that it starts from now on, keep off these processors. Most
/// kernels do not interrupt themselves, not even for SCHED_FIFO: a disk's work for one thread would
/// delay the reply of another on the same processor. Nothing happens if no processor would be left.
void leave_processors(const std::vector<int>& cpus) noexcept;

/// The other thread, too, keeps off those that the calling one keeps off.
void leave_processors_too(std::thread& other) noexcept;

/// Names the calling thread for `top -H` and debuggers; 15 letters at most.
void name_thread(const char* name) noexcept;

/// What a thread whose work can wait takes of the processors.
enum class Share {
  fair,  ///< what every program gets; it just does not push in
  low,   ///< a tenth of that where others are busy, and all that they leave
};
/// The calling thread takes this share from now on. From `low` there is no way back without a
/// privilege: work that somebody waits for belongs on another thread. Not the share of SCHED_IDLE:
/// two busy programs leave nothing of two processors. A reply comes first by SCHED_FIFO.
void take(Share share) noexcept;

}  // namespace sweepd
