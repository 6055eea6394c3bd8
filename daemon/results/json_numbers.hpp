#pragma once

#include <nlohmann/json.hpp>

#include "daemon/results/outcome.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {

// Lengths and angles as the results' JSON has them.

[[nodiscard]] inline nlohmann::ordered_json json_length(double mm) {
  return rounded(mm, kLengthDecimals);
}
[[nodiscard]] inline nlohmann::ordered_json json_angle(double radians) {
  return rounded(degrees(radians), kAngleDecimals);
}
/// Of small angles.
[[nodiscard]] inline nlohmann::ordered_json json_arcsec(double radians) {
  return rounded(arcsec(radians), kArcsecDecimals);
}
/// What is left of poses.
[[nodiscard]] inline nlohmann::ordered_json json_left(const identify::Left& left) {
  return {{"mean_mm", json_length(left.mean_mm)},
          {"rms_mm", json_length(left.rms_mm)},
          {"max_mm", json_length(left.most_mm)}};
}

}  // namespace sweepd
