#pragma once

#include <string>

namespace sweepd {

struct History;

/// What `sweepd history` says to a person; what has changed comes first.
[[nodiscard]] std::string history_text(const History& history);

/// A line a campaign, every number with its 95 % bar. Schema in docs/history.md.
[[nodiscard]] std::string history_csv(const History& history);

}  // namespace sweepd
