#pragma once

namespace identify {

/// Standard deviation of what is spread evenly over one step, in steps: 1 / sqrt(12).
inline constexpr double kEvenlySpread = 0.28867513459481287;

/// A normal distribution's standard deviation, in its median absolute deviation: 1 / Phi^-1(3/4).
inline constexpr double kSigmaByMedian = 1.4826022185056018;
/// The standard error of a median of normal values, in that of their mean: sqrt(pi / 2).
inline constexpr double kErrorOfMedian = 1.2533141373155003;

/// A 95 % interval is the value -+ so many standard uncertainties.
inline constexpr double kSigmasOf95Percent = 1.96;

}  // namespace identify
