#pragma once

#include <cstddef>
#include <optional>

#include "identify/identification.hpp"

namespace identify {

/// The smooth error of a joint's angles, over the turns that it swept.
struct CurveSwing {
  double swing_rad = 0;  ///< from lowest to highest
  double from_rad = 0;   ///< of these turns, from home
  double to_rad = 0;
};
[[nodiscard]] std::optional<CurveSwing> curve_swing(const Identification& found, std::size_t joint);

/// The doubt `angle_arc_mismatch`: while one joint swept, its angle turned otherwise than the
/// target was seen to, by far more than gears err: by another angle, on another way there than
/// back, or along a curve. `usual_mm`: how far its points usually are off their circle.
[[nodiscard]] std::optional<Warning> told_otherwise(const Identification& found, std::size_t joint,
                                                    double usual_mm);

}  // namespace identify
