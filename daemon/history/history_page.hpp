#pragma once

#include <string>
#include <string_view>

namespace sweepd {

struct History;

/// What such a page begins with.
inline constexpr std::string_view kHistoryBegin = "<!DOCTYPE html>\n<!-- sweepd history -->\n";

/// A history as one file of HTML, in the style of the measurement report.
[[nodiscard]] std::string history_page(const History& history);

}  // namespace sweepd
