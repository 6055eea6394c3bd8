#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace identify {

/// Outcome of `search_box`.
struct BoxSearch {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: the directions of the box
  /// The logarithm of the box's volume is proven to be at most this much above the smallest
  /// possible.
  double gap = 0;
  std::size_t cells = 0;  ///< sets of orientations that were looked at
};

/// The orientation of the box of least volume (`rank` 3), or of the rectangle of least area in the
/// plane z = 0 (`rank` 2, all z zero), by branch and bound over all rotations.
///
/// `points`, one a row, have coordinates of the order of 1, and no direction (of the plane for rank
/// 2) in which they extend less than `least_width` > 0; the better that is known, the shorter the
/// search. Thin sets are fine. The search is much shorter when the box lies along the coordinate
/// axes, so it pays to search roughly first, turn the points, and search again.
///
/// It ends at a gap of `tolerance`, or of what rounding allows for thin sets (2e-16 / least_width).
/// It is bounded by `max_products`, the scalar products of points with directions (the default is
/// about half a second's work): round bodies with thousands of extreme points, where thousands of
/// boxes are all but equally small, may end there with a larger gap. No random numbers.
[[nodiscard]] BoxSearch search_box(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, int rank,
                                   double least_width, double tolerance, double max_products = 3e8);

}  // namespace identify
