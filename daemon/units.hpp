#pragma once

namespace sweepd {

// Degrees on the wire and in files, radians inside identify: these two are the border.

inline constexpr double kPi = 3.14159265358979323846;

[[nodiscard]] constexpr double radians(double degrees) {
  return degrees * (kPi / 180);
}
[[nodiscard]] constexpr double degrees(double radians) {
  return radians * (180 / kPi);
}

}  // namespace sweepd
