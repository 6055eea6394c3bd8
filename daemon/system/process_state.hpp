#pragma once

#include <chrono>
#include <cstdint>

namespace sweepd {

/// What this process takes of the machine.
struct ProcessState {
  std::chrono::nanoseconds started{};  ///< since the Unix epoch
  std::chrono::nanoseconds processor_time{};
  std::uint64_t resident_bytes = 0;
  std::uint64_t log_lines_lost = 0;  ///< that nobody got, as who reads the log stood still
};

/// Lets this program open as many files as it may: a robot takes some ten, and programs begin with
/// a limit of 1024.
void allow_open_files() noexcept;

/// Of what it frees, this program keeps some 64 MB for what comes next: one step takes what another
/// one gives back, and pages that come anew from the system would be work. For what computes and
/// ends, before it has other threads.
void keep_memory() noexcept;

/// Now. What cannot be read is zero.
[[nodiscard]] ProcessState process_state();

}  // namespace sweepd
