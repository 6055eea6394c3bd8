#pragma once

#include <string>

#include "daemon/service_status.hpp"

namespace sweepd {

/// What `systemctl status` shows: of each robot the stream, its telegrams, the last sweep and the
/// last result.
[[nodiscard]] std::string status_line(const ServiceStatus& status);

}  // namespace sweepd
