#include "daemon/system/realtime.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <system_error>

#include <pthread.h>
#include <sched.h>
#include <spdlog/fmt/fmt.h>
#include <sys/mman.h>
#include <sys/resource.h>

namespace sweepd {
namespace {

std::string reason(int error) {
  return std::generic_category().message(error);
}

/// The number behind `key` in /proc/self/status; 0 if there is none.
std::uint64_t of_this_process(const std::string& key, std::ios_base& (*base)(std::ios_base&)) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t value = 0;
    if (word == key + ':' && status >> base >> value) return value;
  }
  return 0;
}

bool may_lock_everything() {
  constexpr int kCapIpcLock = 14;  // capabilities(7)
  rlimit limit{};
  if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY) return true;
  return (of_this_process("CapEff", std::hex) >> kCapIpcLock & 1) != 0;
}

std::string list(const std::vector<int>& cpus) {
  std::string text;
  for (const int cpu : cpus) text += (text.empty() ? "" : ", ") + std::to_string(cpu);
  return text;
}

void set_processors(const std::vector<int>& cpus, RealTimeReport& report) {
  cpu_set_t wanted;
  CPU_ZERO(&wanted);
  for (const int cpu : cpus) CPU_SET(static_cast<std::size_t>(cpu), &wanted);
  cpu_set_t got;
  CPU_ZERO(&got);
  int error = pthread_setaffinity_np(pthread_self(), sizeof wanted, &wanted);
  if (error == 0) error = pthread_getaffinity_np(pthread_self(), sizeof got, &got);
  // Of several processors the system takes those that exist.
  if (error == 0 && CPU_EQUAL(&wanted, &got))
    report.granted.push_back("processors " + list(cpus));
  else
    report.refused.push_back("cpus = [" + list(cpus) + "] is not possible (" +
                             (error == 0 ? "some do not exist" : reason(error)) +
                             "): name processors that `lscpu -e` lists and the unit's "
                             "AllowedCPUs permits");
}

void set_priority(int priority, RealTimeReport& report) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  int policy = 0;
  int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) error = pthread_getschedparam(pthread_self(), &policy, &parameters);
  if (error == 0 && policy == SCHED_FIFO && parameters.sched_priority == priority)
    report.granted.push_back(fmt::format("SCHED_FIFO {}", priority));
  else
    report.refused.push_back(
        fmt::format("SCHED_FIFO {0} is not permitted ({1}): set LimitRTPRIO={0} in the unit, or "
                    "rtprio in /etc/security/limits.d",
                    priority, reason(error)));
}

void touch_stack() noexcept {
  constexpr std::size_t kPage = 4096;
  std::array<volatile char, 64 * kPage> stack{};
  for (std::size_t at = 0; at < stack.size(); at += kPage) stack[at] = 0;
}

}  // namespace

void lock_memory(RealTimeReport& report) {
  constexpr const char* kRemedy =
      "): set LimitMEMLOCK=infinity in the unit, or memlock in /etc/security/limits.d";
  if (!may_lock_everything())
    report.refused.push_back(std::string("memory cannot be locked (its limit is too low") +
                             kRemedy);
  else if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0)
    report.refused.push_back("memory cannot be locked (" + reason(errno) + kRemedy);
  else if (of_this_process("VmLck", std::dec) == 0)
    report.refused.push_back(std::string("memory is not locked (the system says 0 kB") + kRemedy);
  else
    report.granted.push_back("memory locked");
}

void enter_real_time(const RealTimeSettings& settings, RealTimeReport& report) {
  touch_stack();
  if (!settings.cpus.empty()) set_processors(settings.cpus, report);
  if (settings.wish == RealTime::off) return;
  set_priority(settings.priority, report);
}

void leave_processors(const std::vector<int>& cpus) noexcept {
  cpu_set_t left;
  CPU_ZERO(&left);
  if (cpus.empty() || pthread_getaffinity_np(pthread_self(), sizeof left, &left) != 0) return;
  for (const int cpu : cpus) CPU_CLR(static_cast<std::size_t>(cpu), &left);
  if (CPU_COUNT(&left) > 0) pthread_setaffinity_np(pthread_self(), sizeof left, &left);
}

void leave_processors_too(std::thread& other) noexcept {
  cpu_set_t mine;
  cpu_set_t left;
  CPU_ZERO(&mine);
  CPU_ZERO(&left);
  if (pthread_getaffinity_np(pthread_self(), sizeof mine, &mine) != 0 ||
      pthread_getaffinity_np(other.native_handle(), sizeof left, &left) != 0 ||
      CPU_EQUAL(&mine, &left))
    return;
  CPU_AND(&left, &left, &mine);
  if (CPU_COUNT(&left) > 0) pthread_setaffinity_np(other.native_handle(), sizeof left, &left);
}

void name_thread(const char* name) noexcept {
  pthread_setname_np(pthread_self(), name);
}

void take(Share share) noexcept {
  constexpr int kLow = 10;
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_BATCH, &none);
  // 0 is the calling thread; the system keeps the sum within its limits.
  if (share == Share::low) setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kLow);
}

}  // namespace sweepd
