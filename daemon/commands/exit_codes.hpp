#pragma once

namespace sweepd {

// How the program ends.
inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;
inline constexpr int kLate =
    3;  // every reply was right: a busy machine, perhaps, and not a wrong server
inline constexpr int kConfigError = 78;  // EX_CONFIG of sysexits.h

}  // namespace sweepd
