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

}  // namespace sweepd
