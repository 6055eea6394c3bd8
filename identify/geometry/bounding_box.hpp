#pragma once

#include <optional>

#include <Eigen/Core>

namespace identify {

/// A box in any orientation, in the frame of the points that it was made for.
struct BoundingBox {
  Eigen::Vector3d lengths_mm;  ///< longest first
  Eigen::Vector3d center_mm;
  /// Columns are the directions of the box in the order of the lengths, right-handed. The first
  /// two point so that their first component of largest size is positive.
  Eigen::Matrix3d orientation;
  /// The volume is proven to be at most this fraction above the smallest possible; for flat sets
  /// the area of the largest face.
  double gap = 0;

  [[nodiscard]] double volume_mm3() const { return lengths_mm.prod(); }
};

/// The box of least volume that contains all points (one a column). It is found by branch and bound
/// over all orientations (`box_search.hpp`): the same optimum as O'Rourke's search over pairs of
/// hull edges (Int. J. Comput. Inf. Sci. 14, 1985), with a proof in numbers and without a convex
/// hull and its decisions about what is coplanar. `gap` is 1e-12, or for thin sets up to about
/// 1e-15 times longest by shortest length; see `search_box` for the bodies where it may be larger.
///
/// Sets without volume: an extent below 1e-10 of the largest (or below the rounding of the
/// coordinates) counts as none. Points in a plane get the rectangle of least area, points on a line
/// their segment, equal points a box without size; what little the points extend otherwise is
/// measured all the same.
///
/// The box contains every point to within rounding (1e-14 of its size and distance from the
/// origin). The same points give the same bits, in whatever order and however often they come.
/// Nothing for no points or a number that is not finite.
[[nodiscard]] std::optional<BoundingBox> minimum_bounding_box(const Eigen::Matrix3Xd& points_mm);

}  // namespace identify
