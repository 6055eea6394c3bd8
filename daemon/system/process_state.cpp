#include "daemon/system/process_state.hpp"

#include <ctime>
#include <fstream>
#include <string>

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include "daemon/system/log.hpp"

namespace sweepd {
namespace {

std::chrono::nanoseconds time_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

/// Since the machine came up. Field 22 of /proc/self/stat, see proc(5), in clock ticks; the second
/// field is in brackets and may hold anything.
std::chrono::nanoseconds start_after_boot() {
  std::ifstream stat("/proc/self/stat");
  std::string word;
  std::getline(stat, word, ')');
  for (int field = 2; field < 21; ++field) stat >> word;
  std::int64_t ticks = 0;
  stat >> ticks;
  return std::chrono::nanoseconds(std::chrono::seconds(ticks)) / sysconf(_SC_CLK_TCK);
}

}  // namespace

void allow_open_files() noexcept {
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
}

void keep_memory() noexcept {
  // NOLINTBEGIN(concurrency-mt-unsafe): there is no other thread yet
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
  // NOLINTEND(concurrency-mt-unsafe)
}

ProcessState process_state() {
  ProcessState state;
  static const auto started =
      time_of(CLOCK_REALTIME) - (time_of(CLOCK_BOOTTIME) - start_after_boot());
  state.started = started;
  state.processor_time = time_of(CLOCK_PROCESS_CPUTIME_ID);
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  state.resident_bytes = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  state.log_lines_lost = log_lines_lost();
  return state;
}

}  // namespace sweepd
