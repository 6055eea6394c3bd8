#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "identify/geometry/line.hpp"

namespace identify {

/// One row of a Denavit-Hartenberg table in the paper's notation (Table 1): from frame i to i+1,
///   T = Tz(b) Rz(theta) Tx(a) Rx(alpha) Ry(beta).
/// The numbers are those of standard (distal) DH with d = b. beta is Hayati's fourth parameter
/// (Hayati, CDC 1983): zero but for axes that are parallel as far as one can tell, where b is zero.
struct DhRow {
  double b_mm = 0;       ///< joint offset: along Z_i from X_i to X_i+1
  double theta_rad = 0;  ///< joint angle: about Z_i from X_i to X_i+1
  double a_mm = 0;       ///< link length: along X_i+1 from Z_i to Z_i+1
  double alpha_rad = 0;  ///< twist angle: about X_i+1 from Z_i to Z_i+1
  double beta_rad = 0;   ///< about the Y that is then
};

/// Pose of frame i+1 in frame i.
[[nodiscard]] Eigen::Isometry3d transform(const DhRow& row);

/// An arm as its maker specifies it. Frame 1 is the robot's base. A joint that turns changes theta
/// of its row; a linear one changes b.
struct Arm {
  std::vector<DhRow> rows;  ///< one a joint; theta, of a linear joint b, as it is at `home_rad`
  /// The controller's joint angles that belong to the rows; of linear joints mm * kDegree.
  std::vector<double> home_rad;
  /// +1 where the controller's positive rotation is about (way along) +Z_i of the row, -1 where
  /// about (along) -Z_i.
  std::vector<int> positive;
  /// The target point in the frame after the last row.
  Eigen::Vector3d tool_mm = Eigen::Vector3d::Zero();
  std::vector<bool> linear;  ///< one a joint, or none: all joints turn

  [[nodiscard]] std::size_t joints() const { return rows.size(); }
  [[nodiscard]] bool is_linear(std::size_t joint) const {
    return joint < linear.size() && linear[joint];
  }
  /// The row of a joint whose controller's angle is `angle_rad`.
  [[nodiscard]] DhRow row_at(std::size_t joint, double angle_rad) const;
};

/// Pose of the frame after the last row in the base, for the controller's joint angles `angles_rad`
/// (as many as the arm has joints). Its origin is not the tool: apply it to `arm.tool_mm`.
[[nodiscard]] Eigen::Isometry3d forward_kinematics(const Arm& arm,
                                                   const std::vector<double>& angles_rad);

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
