#pragma once

#include <Eigen/Core>

#include "identify/geometry/circle_fit.hpp"

namespace identify {

/// The motion that a stroke's samples are compared with: about the normal of a circle, or, of a
/// linear joint, along a straight line. The line is written as an arc: radial and axial are two
/// fixed directions across it, tangential is along it, and the radius is kLinear_mm, so that an
/// arc's formulas hold with a linear joint's angles. Lengths in mm in the measurement frame.
struct ReferenceMotion {
  bool linear = false;
  /// Its arm points along `arm` where the turn x is `zero_rad`, and turns about `normal` by `sense`
  /// times what x changes. Of a linear joint: from the centre along normal x arm.
  CircleFit circle;
  Eigen::Vector3d arm = Eigen::Vector3d::UnitX();
  double sense = 1;
  double zero_rad = 0;
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Identity();  ///< of the tool at `zero_rad`

  /// How it has turned the tool where x has grown by so much.
  [[nodiscard]] Eigen::Matrix3d turned(double by_rad) const;
  /// Rotates the measurement frame's vectors into (radial, axial, tangential) at x.
  [[nodiscard]] Eigen::Matrix3d directions(double turn_rad) const;
  /// Of a point: its radial and axial departure, which are the same at any x.
  [[nodiscard]] Eigen::Vector2d across(const Eigen::Vector3d& point_mm) const;
  /// Of a point: its departure at x, the tangential from x itself.
  [[nodiscard]] Eigen::Vector3d departure(const Eigen::Vector3d& point_mm, double turn_rad) const;
  /// Of the tool: the rotation vector of its departure from where the told angle says, in the
  /// directions at x.
  [[nodiscard]] Eigen::Vector3d departure(const Eigen::Matrix3d& tool, double turn_rad,
                                          double told_rad) const;
  /// The point with this departure at x, its tangential one along the arc.
  [[nodiscard]] Eigen::Vector3d place(double turn_rad, const Eigen::Vector3d& departure) const;
  /// How far the arm to this point has turned about the normal (the point has come along the line),
  /// from where x is `zero_rad`.
  [[nodiscard]] double angle_about(const Eigen::Vector3d& point_mm) const;
  /// x goes on from `last_rad` to the angle of the next sample: of a circle, the short way.
  [[nodiscard]] double step(double last_rad, double angle_rad) const;

  /// Moves x so that it is zero `by_rad` further on.
  void shift(double by_rad);
};

/// About the robust circle through the points, the arm at x = 0 towards `middle_mm`; along the line
/// through them of a linear joint. False where there is none.
[[nodiscard]] bool set_reference(ReferenceMotion& motion, const Eigen::Matrix3Xd& points_mm,
                                 const Eigen::Vector3d& middle_mm);

}  // namespace identify
