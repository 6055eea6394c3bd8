#pragma once

#include <string>
#include <string_view>

#include "daemon/history/history.hpp"

namespace sweepd {

// A history in words: for a terminal, as CSV, as a page, and the sentences that these share.

/// What `sweepd history` says to a person; what has changed comes first.
[[nodiscard]] std::string history_text(const History& history);

/// A line a campaign, every number with its 95 % bar. Schema in docs/history.md.
[[nodiscard]] std::string history_csv(const History& history);

/// What such a page begins with.
inline constexpr std::string_view kHistoryBegin = "<!DOCTYPE html>\n<!-- sweepd history -->\n";

/// A history as one file of HTML, in the style of the measurement report.
[[nodiscard]] std::string history_page(const History& history);

/// "2024-03-01".
[[nodiscard]] std::string date_of(std::chrono::nanoseconds time);
/// "2024-03-01"; "2024-03-01 13:19" where several campaigns are of one day.
[[nodiscard]] std::string date_of(const History& history, std::chrono::nanoseconds time);
/// As many as show two digits of the smallest uncertainty of the lengths, or of the angles.
[[nodiscard]] int decimals_of(const History& history, bool lengths);
/// With as many decimals as its uncertainty tells.
[[nodiscard]] std::string told_with(double value, double sigma);

/// "between 2024-03-01 and 2024-04-01", "since 2024-03-01", "on 2024-03-01".
[[nodiscard]] std::string when(const History& history, const DatedChange& change);
/// A sentence, as in "zero4 jumped by +0.0500 deg (95 %: 0.0480 to 0.0520) between … and …."
[[nodiscard]] std::string change_sentence(const History& history, const DatedChange& change);
[[nodiscard]] std::string friction_sentence(const History& history, const DatedChange& change);
/// What was changed, in a sentence or two: the first of the text and of the page.
[[nodiscard]] std::string verdict_words(const History& history);
/// How the repeatability is known, and what that costs.
[[nodiscard]] std::string repeatability_words(const History& history);
/// How many campaigns stand out, and how many would by chance.
[[nodiscard]] std::string alarms_words(const History& history);

}  // namespace sweepd
