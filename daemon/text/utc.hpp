#pragma once

#include <chrono>
#include <string>

namespace sweepd {

/// A time since the Unix epoch as ISO 8601, in UTC: 2025-01-01T00:00:00.004Z.
[[nodiscard]] std::string utc_text(std::chrono::nanoseconds since_epoch);
/// The same in seconds and the basic form, fit for the name of a folder: 20250101T000000Z.
[[nodiscard]] std::string utc_name(std::chrono::nanoseconds since_epoch);

}  // namespace sweepd
