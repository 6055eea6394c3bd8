#pragma once

#include "daemon/commands/collect_command.hpp"

namespace sweepd {

/// Collects until SIGINT or SIGTERM. Returns the exit code. Throws ConfigError, and
/// std::runtime_error where the spool cannot be used.
[[nodiscard]] int collect_all(const CollectOptions& options);

}  // namespace sweepd
