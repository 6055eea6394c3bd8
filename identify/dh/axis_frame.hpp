#pragma once

#include <Eigen/Geometry>

#include "identify/dh/dh.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

/// A frame whose Z lies along a joint axis.
struct AxisFrame {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d x = Eigen::Vector3d::UnitX();  ///< unit, across z
  Eigen::Vector3d z = Eigen::Vector3d::UnitZ();  ///< unit

  [[nodiscard]] Eigen::Isometry3d pose() const;
};

/// Turns `v` into the plane across the unit vector `axis`, unit; zero if it lies along it.
[[nodiscard]] Eigen::Vector3d turned_across(const Eigen::Vector3d& v, const Eigen::Vector3d& axis);

/// From a frame on one axis to the frame that a DH row leads to on the next.
struct AxisStep {
  DhRow row;  ///< exact for the axis it leads to, however far off the normal is
  /// Along which a_mm is: X of the frame but for beta.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  AxisFrame frame;  ///< after it
};

/// What is not determined comes from outside, so that the row changes smoothly with the axes: the
/// `relation` (b is zero for parallel and coincident axes), and the sense of the common normal, the
/// one closer to `x_near`. For coincident axes `x_near` itself is the normal. No other relation
/// than these two may be given for directions that are parallel to rounding. `b_mm`: what b is for
/// parallel and coincident axes.
[[nodiscard]] AxisStep step_to(const AxisFrame& from, const Line& next, Relation relation,
                               const Eigen::Vector3d& x_near, double b_mm = 0);

}  // namespace identify
