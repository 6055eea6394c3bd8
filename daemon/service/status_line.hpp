#pragma once

#include <string>

#include "daemon/service/service_status.hpp"

namespace sweepd {

/// What `systemctl status` shows: of each robot the stream, its telegrams, the last sweep and the
/// last result; before them what is wrong: threads that stand still, robots that are not served.
[[nodiscard]] std::string status_line(const ServiceStatus& status);

}  // namespace sweepd
