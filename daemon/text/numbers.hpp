#pragma once

#include <string>

namespace sweepd {

/// `value` with so many decimals, whatever the locale; never "-0.000".
[[nodiscard]] std::string fixed(double value, int decimals);

/// The same, appended to `text`.
void append_fixed(std::string& text, double value, int decimals);

/// The same without zeros at its end: a measured number with the decimals that it came with, if
/// these are no more.
void append_measured(std::string& text, double value, int decimals);

/// Coverage factor of the expanded uncertainty U = k u (JCGM 100:2008, 6.2.1).
inline constexpr double kCoverage = 2;

/// Below that a probability is said to be smaller.
inline constexpr double kLeastChance = 1e-4;
/// "0.0312", "<0.0001".
[[nodiscard]] std::string chance_text(double chance);
/// "43 %", "1.2 %", "less than 0.01 %".
[[nodiscard]] std::string share_text(double chance);

/// As many decimals as show two digits of `uncertainty`, within these; the most where it is zero.
[[nodiscard]] int decimals_for(double uncertainty, int fewest, int most);
/// Those of a change of an arm's numbers, mm or degrees.
inline constexpr int kFewestOfChange = 3, kMostOfChange = 7;

/// `value` rounded to so many decimals: what a file holds of it.
[[nodiscard]] double rounded(double value, int decimals);

}  // namespace sweepd
