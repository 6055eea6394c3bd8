#pragma once

#include "identify/poses/pose_fit.hpp"

namespace identify {

/// Whether the first half of the poses, in their order, tells the same arm as the second: it does
/// not where the arm warms up, or the device is nudged.
///
/// The score of the first half's log likelihood at the fit to all, g = sum of J' V^-1 r over it,
/// has the covariance M = N1 - N1 N^-1 N1 where all poses are of one arm, with the information N1
/// of the half and N of all (Rao, Proc. Camb. Phil. Soc. 44, 1948). M^-1 g is how the halves
/// differ.
struct PoseDrift {
  double chi_squared = 0;  ///< g' M^-1 g
  int numbers = 0;         ///< its degrees of freedom
  /// Root mean square over the poses of how far the halves have the target apart, less what noise
  /// makes of it.
  double moved_mm = 0;
  bool seen = false;  ///< of one arm's poses in one of a thousand files
};

/// Nothing is seen where a half has too few poses to tell an arm.
[[nodiscard]] PoseDrift drift_of(const PoseFit& fit);

}  // namespace identify
