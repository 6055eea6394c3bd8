#pragma once

#include <optional>

#include "identify/identification.hpp"

namespace identify {

/// Where one sample of a sweep lies to the chain, the joints that did not sweep taken at their
/// measured angles.
struct SeenTurn {
  double turn_rad = 0;   ///< from home, at which the target is seen about the sweeping joint's axis
  double axial_mm = 0;   ///< distance along that axis from where the chain has the target
  double radial_mm = 0;  ///< distance across it; of a linear joint, these two are across it
  /// The controller's angle minus the one seen; nothing without angles.
  std::optional<double> angle_error_rad;
  std::optional<double> curve_rad;  ///< the smooth curve of that error there
};

/// For a sample with a position, of a sweep of `joint` at `target`. Nothing without the joint's
/// axis.
[[nodiscard]] std::optional<SeenTurn> seen_turn(const Identification& found, std::size_t joint,
                                                std::size_t target, const Sample& sample);

}  // namespace identify
