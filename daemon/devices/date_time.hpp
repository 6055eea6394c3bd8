#pragma once

#include <optional>
#include <string_view>

namespace sweepd {

/// Seconds, from a moment that all dates share, of a date with a time of day:
/// 2024-03-14T13:22:33.5, 3/14/2024 1:22:33.5 PM, 14.03.2024 13:22:33,5. Seconds from midnight
/// where there is no date. With slashes the month is first, unless it cannot be one. Time zones
/// count. Nothing for anything else.
[[nodiscard]] std::optional<double> seconds_of_date(std::string_view text);

}  // namespace sweepd
