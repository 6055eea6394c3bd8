#pragma once

#include <string>
#include <string_view>

#include "daemon/results/outcome.hpp"

namespace sweepd {

/// What the numbers are of.
enum class Described {
  controller_model,  ///< positions that the controller computed from its angles
  arm,               ///< positions that a device measured
};

/// RIst is computed by the controller from its axis angles: what was seen only through RSI is the
/// controller's model. So are points from elsewhere where they follow from the angles beside them
/// to the printed decimals.
[[nodiscard]] Described described(const Outcome& outcome);

/// As in result.json.
[[nodiscard]] std::string_view text(Described described) noexcept;
/// What the numbers are of, and what they are good for: one paragraph.
[[nodiscard]] std::string explanation(const Outcome& outcome);

}  // namespace sweepd
