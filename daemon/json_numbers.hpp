#pragma once

#include <nlohmann/json.hpp>

#include "daemon/numbers.hpp"
#include "daemon/outcome.hpp"
#include "daemon/units.hpp"

namespace sweepd {

// Lengths and angles as the results' JSON has them.

[[nodiscard]] inline nlohmann::ordered_json json_length(double mm) {
  return rounded(mm, kLengthDecimals);
}
[[nodiscard]] inline nlohmann::ordered_json json_angle(double radians) {
  return rounded(degrees(radians), kAngleDecimals);
}

}  // namespace sweepd
