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

/// As many decimals as show two digits of `uncertainty`, within these; the most where it is zero.
[[nodiscard]] int decimals_for(double uncertainty, int fewest, int most);
/// Those of a change of an arm's numbers, mm or degrees.
inline constexpr int kFewestOfChange = 3, kMostOfChange = 7;

/// `value` rounded to so many decimals: what a file holds of it.
[[nodiscard]] double rounded(double value, int decimals);

}  // namespace sweepd
