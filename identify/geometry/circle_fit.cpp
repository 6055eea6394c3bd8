#include "identify/geometry/circle_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "identify/geometry/median.hpp"
#include "identify/geometry/sines.hpp"

namespace identify {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixX3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Points whose second singular value is below this share of the first lie on a line.
constexpr double kLine = 1e-9;

/// Coordinates in the plane of the circle, from its centre: rows x, y, out of plane.
Matrix3Xd in_circle_frame(const CircleFit& circle, const Matrix3Xd& points, Matrix3d& frame) {
  const Vector3d z = circle.normal;
  const Vector3d x = z.unitOrthogonal();
  frame << x, z.cross(x), z;
  return frame.transpose() * (points.colwise() - circle.center_mm);
}

double rms(const VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// The angle swept about the centre: the extent of the running sum of the steps from point to
/// point.
double swept_angle(const Matrix3Xd& local) {
  double angle = 0;
  double lowest = 0;
  double highest = 0;
  for (Eigen::Index i = 1; i < local.cols(); ++i) {
    const double x0 = local(0, i - 1), y0 = local(1, i - 1), x1 = local(0, i), y1 = local(1, i);
    angle += small_angle(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1);
    lowest = std::min(lowest, angle);
    highest = std::max(highest, angle);
  }
  return highest - lowest;
}

}  // namespace

std::optional<CircleFit> fit_circle(const Matrix3Xd& points) {
  const auto count = points.cols();
  if (count < 4 || !points.allFinite()) return std::nullopt;
  const Vector3d centroid = points.rowwise().mean();                    // eq. 1
  const MatrixX3d centred = (points.colwise() - centroid).transpose();  // eq. 2
  // N = Q R has the singular values and V of the small R.                               eq. 3
  const Matrix3d r = Eigen::HouseholderQR<MatrixX3d>(centred)
                         .matrixQR()
                         .topRows<3>()
                         .triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Matrix3d> svd(r, Eigen::ComputeFullV);
  const Vector3d& sizes = svd.singularValues();
  if (sizes(0) <= 0 || sizes(1) <= kLine * sizes(0)) return std::nullopt;
  const MatrixX3d local = centred * svd.matrixV();  // eq. 4

  // Lengths are divided by the spread of the points, so that the columns are of one size.
  const double scale = sizes(0) / std::sqrt(static_cast<double>(count));
  const VectorXd x = local.col(0) / scale;
  const VectorXd y = local.col(1) / scale;
  // In principal coordinates the columns 2x, 2y and 1 of eq. 6 are orthogonal: the least squares of
  // eq. 8 are three projections.
  const VectorXd b = x.array().square() + y.array().square();  // eq. 7
  const Vector3d c(x.dot(b) / (2 * x.squaredNorm()), y.dot(b) / (2 * y.squaredNorm()), b.mean());
  const double squared_radius = c(0) * c(0) + c(1) * c(1) + c(2);  // eq. 9
  if (!(squared_radius > 0) || !c.allFinite()) return std::nullopt;

  CircleFit fit;
  fit.points = static_cast<std::size_t>(count);
  fit.radius_mm = scale * std::sqrt(squared_radius);
  fit.center_mm = centroid + scale * (svd.matrixV().leftCols<2>() * c.head<2>());
  fit.normal = svd.matrixV().col(2);
  Vector3d turned = Vector3d::Zero();
  for (Eigen::Index i = 1; i < count; ++i)
    turned += (points.col(i - 1) - fit.center_mm).cross(points.col(i) - points.col(i - 1));
  if (turned.dot(fit.normal) < 0) fit.normal = -fit.normal;

  Matrix3d frame;
  const Matrix3Xd round = in_circle_frame(fit, points, frame);
  fit.plane_rms_mm = rms(round.row(2).transpose());
  fit.radial_rms_mm =
      rms((round.topRows<2>().colwise().norm().array() - fit.radius_mm).matrix().transpose());
  fit.arc_rad = swept_angle(round);
  const bool finite = std::isfinite(fit.radius_mm) && fit.center_mm.allFinite() &&
                      std::isfinite(fit.plane_rms_mm) && std::isfinite(fit.radial_rms_mm);
  return finite ? std::optional(fit) : std::nullopt;
}

CircleResidual residual(const CircleFit& circle, const Vector3d& point) {
  const Vector3d from_center = point - circle.center_mm;
  const double height = from_center.dot(circle.normal);
  return {height, (from_center - height * circle.normal).norm() - circle.radius_mm};
}

namespace {

/// Of a place in the circle's plane, from its centre: what the plane's numbers and the circle's do
/// there.
Vector3d by_plane_at(double x, double y, double radius) {
  return {1, x / radius, y / radius};
}
Vector3d by_circle_at(double x, double y) {
  return Vector3d(x, y, 0).normalized() + Vector3d::UnitZ();
}

}  // namespace

CircleCovariance::CircleCovariance(const CircleFit& of, const Matrix3Xd& points,
                                   double plane_sigma_mm, double radial_sigma_mm)
    : circle(of) {
  const Matrix3Xd round = in_circle_frame(circle, points, frame);
  // Out of plane: z = z0 + x tx + y ty; the plane's normal is then (-tx, -ty, 1). Coordinates are
  // from the centre and in radii, so that z0 is the centre's own error along the normal.
  Matrix3d of_plane = Matrix3d::Zero();
  // In the plane: the radial error of a point at angle phi is (cos phi, sin phi, 1)(dx, dy, dr).
  Matrix3d of_circle = Matrix3d::Zero();
  for (Eigen::Index i = 0; i < round.cols(); ++i) {
    const Vector3d out = by_plane_at(round(0, i), round(1, i), circle.radius_mm);
    of_plane += out * out.transpose();
    const Vector3d across = by_circle_at(round(0, i), round(1, i));
    of_circle += across * across.transpose();
  }
  plane = plane_sigma_mm * plane_sigma_mm * of_plane.inverse();
  radial = radial_sigma_mm * radial_sigma_mm * of_circle.inverse();
}

double CircleCovariance::sigma_mm(const Vector3d& point_mm) const {
  constexpr double kRoughly = 0.02;
  const double tilts = std::sqrt(std::max(plane(1, 1), plane(2, 2)));  // times the radius
  if (!(std::max(radius_sigma_mm(), tilts) < kRoughly * circle.radius_mm))
    return std::numeric_limits<double>::infinity();
  const Vector3d at = frame.transpose() * (point_mm - circle.center_mm);
  const Vector3d across = by_circle_at(at(0), at(1));
  const Vector3d out =
      by_plane_at(circle.radius_mm * across(0), circle.radius_mm * across(1), circle.radius_mm);
  return std::sqrt(std::max(out.dot(plane * out), across.dot(radial * across)));
}

Matrix6d axis_covariance(const CircleFit& circle, const Matrix3Xd& points, double plane_sigma_mm,
                         double radial_sigma_mm) {
  const CircleCovariance known(circle, points, plane_sigma_mm, radial_sigma_mm);
  // From (z0, tx r, ty r) and (dx, dy) to the direction and the centre.
  Eigen::Matrix<double, 6, 3> by_plane = Eigen::Matrix<double, 6, 3>::Zero();
  by_plane.block<3, 1>(3, 0) = known.frame.col(2);
  by_plane.block<3, 2>(0, 1) = -known.frame.leftCols<2>() / circle.radius_mm;
  Eigen::Matrix<double, 6, 2> by_circle = Eigen::Matrix<double, 6, 2>::Zero();
  by_circle.bottomRows<3>() = known.frame.leftCols<2>();
  return by_plane * known.plane * by_plane.transpose() +
         by_circle * known.radial.topLeftCorner<2, 2>() * by_circle.transpose();
}

namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Half of them bad, one of so many triples is all good but for once in 10^8 times.
constexpr int kTriples = 150;
/// Medians of more points than these would not choose better.
constexpr Index kJudges = 400;
/// So few tell what is hopeless, by their nearest quarter: half of them may be bad.
constexpr Index kFirstJudges = 40;

std::optional<CircleFit> circle_through(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d u = b - a;
  const Vector3d v = c - a;
  const Vector3d w = u.cross(v);
  const double squared = w.squaredNorm();
  if (!(squared > 1e-12 * u.squaredNorm() * v.squaredNorm())) return std::nullopt;
  CircleFit circle;
  const Vector3d to_center =
      (u.squaredNorm() * v.cross(w) + v.squaredNorm() * w.cross(u)) / (2 * squared);
  circle.center_mm = a + to_center;
  circle.normal = w / std::sqrt(squared);
  circle.radius_mm = to_center.norm();
  return circle;
}

double squared_distance(const CircleFit& circle, const Vector3d& point) {
  const CircleResidual off = residual(circle, point);
  return off.plane_mm * off.plane_mm + off.radial_mm * off.radial_mm;
}

/// Some of the points, by whose distances circles are judged.
class Judges {
 public:
  /// So many at least, where there are as many, evenly from all.
  Judges(const Matrix3Xd& points, Index wanted)
      : points_(points(Eigen::all, Eigen::seq(0, points.cols() - 1,
                                              std::max<Index>(1, points.cols() / wanted)))),
        origin_(points_.rowwise().mean()) {
    points_.colwise() -= origin_.array();
    sizes_ = points_.square().colwise().sum();
  }

  /// Whether more than a share of so many of them are nearer than that: to count is a tenth of the
  /// work of sorting.
  [[nodiscard]] bool nearer(double share, const CircleFit& circle, double squared) {
    measure(circle);
    Index near = 0;
    for (const double distance : squared_) near += distance < squared ? 1 : 0;
    return near > static_cast<Index>(share * static_cast<double>(squared_.size()));
  }
  /// The squared distance that half of them have at most.
  [[nodiscard]] double median_squared(const CircleFit& circle) {
    measure(circle);
    return median_in({squared_.data(), static_cast<std::size_t>(squared_.size())});
  }

 private:
  void measure(const CircleFit& circle) {
    const Vector3d& n = circle.normal;
    const Vector3d c = circle.center_mm - origin_;
    const auto &x = points_.row(0), &y = points_.row(1), &z = points_.row(2);
    height_ = n(0) * x + n(1) * y + n(2) * z - n.dot(c);
    squared_ = sizes_ - 2 * c(0) * x - 2 * c(1) * y - 2 * c(2) * z + c.squaredNorm();
    squared_ = height_.square() +
               ((squared_ - height_.square()).max(0).sqrt() - circle.radius_mm).square();
  }

  using Row = Eigen::Array<double, 1, Eigen::Dynamic>;
  Eigen::Array<double, 3, Eigen::Dynamic, Eigen::RowMajor> points_;  // from the origin
  Vector3d origin_;
  Row sizes_;             // their squared lengths
  Row height_, squared_;  // room for one circle
};

/// Whether all points are so close that none can have turned the circle over.
bool sure(const std::optional<CircleFit>& circle) {
  constexpr double kSure_mm = 0.05;
  return circle && std::max(circle->plane_rms_mm, circle->radial_rms_mm) <= kSure_mm;
}

/// By least median of squares.
std::optional<CircleFit> searched_circle(const Matrix3Xd& points) {
  if (points.cols() < 4 || !points.allFinite()) return std::nullopt;
  std::mt19937 random(1);
  // Without std::uniform_int_distribution, whose numbers differ from library to library.
  const auto third = [&](Index part) {
    const Index from = part * points.cols() / 3;
    const Index count = std::max<Index>(1, (part + 1) * points.cols() / 3 - from);
    return points.col(from + static_cast<Index>(random() % static_cast<std::uint32_t>(count)));
  };
  Judges first(points, kFirstJudges), judges(points, kJudges);
  std::optional<CircleFit> best;
  double least = std::numeric_limits<double>::infinity();
  for (int triple = 0; triple < kTriples; ++triple) {
    const Vector3d a = third(0), b = third(1), c = third(2);
    const auto circle = circle_through(a, b, c);
    if (!circle || !first.nearer(0.25, *circle, least) || !judges.nearer(0.5, *circle, least))
      continue;
    least = judges.median_squared(*circle);
    best = circle;
  }
  if (!best) return std::nullopt;
  // A median of chi squared with two degrees of freedom is 1.386; the circle through three points
  // is itself off, so be generous. Twice, since the second circle is much better than the first.
  for (int round = 0; round < 2; ++round) {
    const double bound =
        36 * std::pow(for_few(points.cols()), 2) * judges.median_squared(*best) / 1.386;
    Matrix3Xd close(3, points.cols());
    Index count = 0;
    for (Index i = 0; i < points.cols(); ++i)
      if (squared_distance(*best, points.col(i)) <= bound) close.col(count++) = points.col(i);
    const auto refined = fit_circle(close.leftCols(count));
    if (!refined) break;
    best = refined;
  }
  return best->points > 0 ? best : fit_circle(points);
}

}  // namespace

std::optional<CircleFit> fit_robust_circle(const Matrix3Xd& points) {
  const auto plain = fit_circle(points);
  return sure(plain) ? plain : searched_circle(points);
}

std::optional<UsualCircle> fit_usual_circle(const Matrix3Xd& points) {
  constexpr double kComputing_mm = 1e-6;
  const auto plain = fit_circle(points);
  if (const auto robust = sure(plain) ? std::nullopt : searched_circle(points)) {
    std::vector<double> distances;
    for (Index i = 0; i < points.cols(); ++i)
      distances.push_back(std::sqrt(squared_distance(*robust, points.col(i))));
    const double within_mm =
        std::max(kComputing_mm, kOutlierDistances * for_few(points.cols()) * median_of(distances));
    Matrix3Xd close(3, points.cols());
    Index count = 0;
    for (Index i = 0; i < points.cols(); ++i)
      if (distances[static_cast<std::size_t>(i)] <= within_mm) close.col(count++) = points.col(i);
    if (count < points.cols())
      if (const auto circle = fit_circle(close.leftCols(count)))
        return UsualCircle{*circle, within_mm};
  }
  if (!plain) return std::nullopt;
  return UsualCircle{*plain, std::numeric_limits<double>::infinity()};
}

}  // namespace identify
