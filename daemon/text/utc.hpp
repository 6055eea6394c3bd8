#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace sweepd {

/// A time since the Unix epoch as ISO 8601, in UTC: 2025-01-01T00:00:00.004Z.
[[nodiscard]] std::string utc_text(std::chrono::nanoseconds since_epoch);
/// The same in seconds and the basic form, fit for the name of a folder: 20250101T000000Z.
[[nodiscard]] std::string utc_name(std::chrono::nanoseconds since_epoch);
/// A date, or a date with its time of day, in UTC and in either form: 2025-01-01, 2025-01-01T10:30,
/// 2025-01-01T10:30:05.25Z, 20250101T103005Z. Of the years 1700 to 2200. Nothing for
/// anything else.
[[nodiscard]] std::optional<std::chrono::nanoseconds> parse_utc(std::string_view text);

}  // namespace sweepd
