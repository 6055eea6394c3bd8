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
    angle += std::atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1);
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
  MatrixX3d a(count, 3);  // eqs. 6, 7
  a << 2 * x, 2 * y, VectorXd::Ones(count);
  const VectorXd b = x.array().square() + y.array().square();
  const Vector3d c = a.householderQr().solve(b);                   // eq. 8
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

Matrix6d axis_covariance(const CircleFit& circle, const Matrix3Xd& points, double plane_sigma_mm,
                         double radial_sigma_mm) {
  Matrix3d frame;
  const Matrix3Xd round = in_circle_frame(circle, points, frame);
  // Out of plane: z = z0 + x tx + y ty; the plane's normal is then (-tx, -ty, 1). Coordinates are
  // from the centre and in radii, so that z0 is the centre's own error along the normal.
  Matrix3d plane = Matrix3d::Zero();
  // In the plane: the radial error of a point at angle phi is (cos phi, sin phi, 1)(dx, dy, dr).
  Matrix3d radial = Matrix3d::Zero();
  for (Eigen::Index i = 0; i < round.cols(); ++i) {
    const Vector3d out(1, round(0, i) / circle.radius_mm, round(1, i) / circle.radius_mm);
    plane += out * out.transpose();
    const Vector3d across = Vector3d(round(0, i), round(1, i), 0).normalized() + Vector3d::UnitZ();
    radial += across * across.transpose();
  }
  const Matrix3d plane_covariance = plane_sigma_mm * plane_sigma_mm * plane.inverse();
  const Matrix3d radial_covariance = radial_sigma_mm * radial_sigma_mm * radial.inverse();

  // From (z0, tx r, ty r) and (dx, dy) to the direction and the centre.
  Eigen::Matrix<double, 6, 3> by_plane = Eigen::Matrix<double, 6, 3>::Zero();
  by_plane.block<3, 1>(3, 0) = frame.col(2);
  by_plane.block<3, 2>(0, 1) = -frame.leftCols<2>() / circle.radius_mm;
  Eigen::Matrix<double, 6, 2> by_circle = Eigen::Matrix<double, 6, 2>::Zero();
  by_circle.bottomRows<3>() = frame.leftCols<2>();
  return by_plane * plane_covariance * by_plane.transpose() +
         by_circle * radial_covariance.topLeftCorner<2, 2>() * by_circle.transpose();
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

/// The squared distance that a share of so many of the points has at most.
double squared_within(double share, const CircleFit& circle, const Matrix3Xd& points, Index judges,
                      std::vector<double>& room) {
  room.clear();
  const Index step = std::max<Index>(1, points.cols() / judges);
  for (Index i = 0; i < points.cols(); i += step)
    room.push_back(squared_distance(circle, points.col(i)));
  const auto place =
      room.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(room.size()));
  std::nth_element(room.begin(), place, room.end());
  return *place;
}

double median_squared(const CircleFit& circle, const Matrix3Xd& points, std::vector<double>& room) {
  return squared_within(0.5, circle, points, kJudges, room);
}

}  // namespace

std::optional<CircleFit> fit_robust_circle(const Matrix3Xd& points) {
  if (points.cols() < 4 || !points.allFinite()) return std::nullopt;
  std::mt19937 random(1);
  // Without std::uniform_int_distribution, whose numbers differ from library to library.
  const auto third = [&](Index part) {
    const Index from = part * points.cols() / 3;
    const Index count = std::max<Index>(1, (part + 1) * points.cols() / 3 - from);
    return points.col(from + static_cast<Index>(random() % static_cast<std::uint32_t>(count)));
  };
  std::vector<double> room;
  std::optional<CircleFit> best;
  double least = std::numeric_limits<double>::infinity();
  for (int triple = 0; triple < kTriples; ++triple) {
    const Vector3d a = third(0), b = third(1), c = third(2);
    const auto circle = circle_through(a, b, c);
    if (!circle || squared_within(0.25, *circle, points, kFirstJudges, room) > least) continue;
    if (const double median = median_squared(*circle, points, room); median < least) {
      least = median;
      best = circle;
    }
  }
  if (!best) return std::nullopt;
  // A median of chi squared with two degrees of freedom is 1.386; the circle through three points
  // is itself off, so be generous. Twice, since the second circle is much better than the first.
  for (int round = 0; round < 2; ++round) {
    const double bound = 36 * median_squared(*best, points, room) / 1.386;
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

}  // namespace identify
