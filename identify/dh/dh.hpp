#pragma once

#include <vector>

#include <Eigen/Geometry>

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

}  // namespace identify
