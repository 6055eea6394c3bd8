#pragma once

#include <cmath>
#include <optional>

#include <Eigen/Core>

namespace identify {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// The circle through the positions of one target point while one joint turned.
struct CircleFit {
  Eigen::Vector3d center_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit; the points run about it, right-hand
  double radius_mm = 0;
  double arc_rad = 0;        ///< from the first to the last angle about the centre that was reached
  double plane_rms_mm = 0;   ///< distances of the points from the plane
  double radial_rms_mm = 0;  ///< distances from the circle within the plane
  std::size_t points = 0;
};

/// The paper's fit: plane by the singular value decomposition of the centred points (eqs. 1-4),
/// circle within it by linear least squares (eqs. 5-8), r = sqrt(c1^2 + c2^2 + k3) (eq. 9 prints
/// -k3, which its own definition of k3 contradicts; eqs. 6 and 7 print 2x' twice for 2x', 2y').
///
/// `points_mm` are columns in the order of the motion. The sign of the normal is that of the
/// motion, summed over the whole stroke, so that a stroke there and back a little is not misjudged.
/// Nothing for fewer than four points or points on a line or in one place.
[[nodiscard]] std::optional<CircleFit> fit_circle(const Eigen::Matrix3Xd& points_mm);

/// Distances of a point from a circle: from its plane, and within the plane from the circle.
struct CircleResidual {
  double plane_mm = 0;
  double radial_mm = 0;
};
[[nodiscard]] CircleResidual residual(const CircleFit& circle, const Eigen::Vector3d& point_mm);

/// How certain a circle is, first order, for independent errors of `plane_sigma_mm` along the
/// normal and `radial_sigma_mm` across the arc.
struct CircleCovariance {
  /// By how its points lie about it; of errors that are alike, so many count as one.
  CircleCovariance(const CircleFit& of, const Eigen::Matrix3Xd& points_mm, double alike)
      : CircleCovariance(of, points_mm, std::sqrt(alike) * of.plane_rms_mm,
                         std::sqrt(alike) * of.radial_rms_mm) {}
  CircleCovariance(const CircleFit& of, const Eigen::Matrix3Xd& points_mm, double plane_sigma_mm,
                   double radial_sigma_mm);

  /// Of the circle where it comes nearest to a point, in the direction known worse: a short arc
  /// tells little of the rest of its circle. Infinite where the radius is known no better than to a
  /// fiftieth, or the plane to so much of a radian: first order tells nothing then.
  [[nodiscard]] double sigma_mm(const Eigen::Vector3d& point_mm) const;
  [[nodiscard]] double radius_sigma_mm() const { return std::sqrt(radial(2, 2)); }

  CircleFit circle;
  Eigen::Matrix3d frame;   ///< two directions in the plane, and the normal
  Eigen::Matrix3d plane;   ///< of the centre's height, and the tilts about both, times the radius
  Eigen::Matrix3d radial;  ///< of the centre in the plane, and the radius
};

/// Covariance of the axis that a circle gives, (direction, centre) in this order, first order, for
/// independent errors of `plane_sigma_mm` along the normal and `radial_sigma_mm` across the arc.
/// A target close to the axis or a short arc shows here, not in the residuals.
[[nodiscard]] Matrix6d axis_covariance(const CircleFit& circle, const Eigen::Matrix3Xd& points_mm,
                                       double plane_sigma_mm, double radial_sigma_mm);

/// Points so many times the middle one's distance off a robust circle are outliers.
inline constexpr double kOutlierDistances = 6;

/// The circle that fits most of the points: least median of squares (Rousseeuw, JASA 79, 1984) over
/// circles through three points each, then `fit_circle` of those points that lie close to it. Up to
/// nearly half of the points may be anywhere. `fit_circle` alone where that comes to within
/// 0.05 mm of all, root mean square. Deterministic. Nothing where `fit_circle` has nothing.
[[nodiscard]] std::optional<CircleFit> fit_robust_circle(const Eigen::Matrix3Xd& points_mm);

/// `fit_circle` of all points but strays: a single point far off would turn it over.
struct UsualCircle {
  CircleFit circle;
  double within_mm = 0;  ///< points farther off it are strays; infinite: there is none
};
[[nodiscard]] std::optional<UsualCircle> fit_usual_circle(const Eigen::Matrix3Xd& points_mm);

}  // namespace identify
