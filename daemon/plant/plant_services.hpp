#pragma once

#include <csignal>

#include "daemon/commands/plant_commands.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/process_events.hpp"

namespace sweepd {

/// Publishes until SIGINT or SIGTERM. Returns the exit code. Throws ConfigError, and
/// std::runtime_error where the spool cannot be used or another publisher uses it.
[[nodiscard]] int publish_all(const PublishOptions& options);

/// Collects until SIGINT or SIGTERM. Returns the exit code. Throws ConfigError, and
/// std::runtime_error where the spool cannot be used.
[[nodiscard]] int collect_all(const CollectOptions& options);

/// Whether a signal came that ends a service. SIGHUP, by which `sweepd run` reads its settings
/// again, would end these, and systemd takes that for an end in order: it is said to change
/// nothing.
inline bool is_ended(ProcessEvents& events) {
  while (const auto signal = events.next_signal()) {
    if (*signal != SIGHUP) return true;
    Log().note("SIGHUP changes nothing: the settings are read at the start; restart the service");
  }
  return false;
}

}  // namespace sweepd
