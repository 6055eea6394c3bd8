#pragma once

#include "daemon/commands/plant_commands.hpp"

namespace sweepd {

/// Publishes until SIGINT or SIGTERM. Returns the exit code. Throws ConfigError, and
/// std::runtime_error where the spool cannot be used or another publisher uses it.
[[nodiscard]] int publish_all(const PublishOptions& options);

/// Collects until SIGINT or SIGTERM. Returns the exit code. Throws ConfigError, and
/// std::runtime_error where the spool cannot be used.
[[nodiscard]] int collect_all(const CollectOptions& options);

}  // namespace sweepd
