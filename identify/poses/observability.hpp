#pragma once

#include "identify/poses/pose_fit.hpp"

namespace identify {

/// Angles count by what they do at this distance.
inline constexpr double kMetre_mm = 1000;

/// How well the poses show the model's numbers. The rows are divided by their noise, angles are in
/// rad times kMetre_mm.
struct Observability {
  double largest = 0;   ///< singular value, 1/mm
  double smallest = 0;  ///< Nahvi & Hollerbach, ICRA 1996: O3
  double mean = 0;      ///< geometric, over the root of how many poses there are: O1 (Borm & Menq)
  /// The largest standard uncertainty of a predicted position over the poses, in its worst
  /// direction.
  double displacement_mm = 0;
};

/// Of the poses that were fitted.
[[nodiscard]] Observability observability_of(const PoseFit& fit);

}  // namespace identify
