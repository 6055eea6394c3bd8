#pragma once

#include "daemon/commands/publish_command.hpp"

namespace sweepd {

/// Publishes until SIGINT or SIGTERM. Returns the exit code. Throws ConfigError, and
/// std::runtime_error where the spool cannot be used or another publisher uses it.
[[nodiscard]] int publish_all(const PublishOptions& options);

}  // namespace sweepd
