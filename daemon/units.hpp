#pragma once

namespace sweepd {

// Degrees on the wire and in files, radians inside identify: these are the border.

inline constexpr double kPi = 3.14159265358979323846;

/// Beyond what anyone measures in mm, degrees or seconds, and harmless to the numerics.
inline constexpr double kLargestMeasured = 1e12;

[[nodiscard]] constexpr double radians(double degrees) {
  return degrees * (kPi / 180);
}
[[nodiscard]] constexpr double degrees(double radians) {
  return radians * (180 / kPi);
}
[[nodiscard]] constexpr double arcsec(double radians) {
  return 3600 * degrees(radians);
}

}  // namespace sweepd
