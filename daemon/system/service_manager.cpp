#include "daemon/system/service_manager.hpp"

#include <cstdint>

#include <systemd/sd-daemon.h>
#include <time.h>

namespace sweepd::service_manager {
namespace {

/// What comes of it is of no use to us.
void tell(const std::string& what) noexcept {
  sd_notify(0, what.c_str());
}

std::uint64_t monotonic_us() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000 +
         static_cast<std::uint64_t>(time.tv_nsec) / 1'000;
}

}  // namespace

void ready() noexcept {
  tell("READY=1");
}

void reloading() noexcept {
  // The time is what Type=notify-reload of later versions asks for.
  tell("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(monotonic_us()));
}

void stopping() noexcept {
  tell("STOPPING=1\nSTATUS=Ending: the last result and the recording are being completed");
}

void status(const std::string& text) noexcept {
  tell("STATUS=" + text);
}

void beat() noexcept {
  tell("WATCHDOG=1");
}

}  // namespace sweepd::service_manager
