#include "identify/geometry/line_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <Eigen/Cholesky>

#include "identify/geometry/line.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/symmetric_eigen.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Half of them bad, one of so many pairs is all good but for once in 10^12 times.
constexpr double kPairs = 100;
/// As few where all points are good: some pairs are too close to each other to tell a direction.
constexpr double kFewestPairs = 25;
constexpr Index kLineJudges = 400;

Eigen::VectorXd squared_distances(const LineFit& line, const Matrix3Xd& points) {
  const Matrix3Xd from = points.colwise() - line.point_mm;
  // Not by Pythagoras: of exact points nothing but rounding would be left.
  return (from - line.direction * (line.direction.transpose() * from))
      .colwise()
      .squaredNorm()
      .transpose();
}

/// Up to where points are close, by the distances of the usual ones.
double close_squared(const Eigen::VectorXd& squared_distances, double rounding) {
  constexpr double kMedian = 1.386;  // of chi squared with two degrees of freedom
  const double median = median_of({squared_distances.begin(), squared_distances.end()});
  return 36 * (median / kMedian + rounding * rounding);
}

/// Medians of more points than so many would not choose better.
Matrix3Xd judges_of(const Matrix3Xd& points) {
  const Index step = std::max<Index>(1, points.cols() / kLineJudges);
  Matrix3Xd few(3, (points.cols() + step - 1) / step);
  for (Index i = 0; i < few.cols(); ++i) few.col(i) = points.col(i * step);
  return few;
}

LineFit through_most(const Matrix3Xd& points, double rounding) {
  std::mt19937 random(1);
  const auto any = [&] {
    return points.col(static_cast<Index>(random() % static_cast<std::uint32_t>(points.cols())));
  };
  LineFit best;
  double least = std::numeric_limits<double>::infinity(), pairs = kPairs;
  for (int pair = 0; pair < pairs; ++pair) {
    const Vector3d a = any(), b = any();
    if (!((b - a).squaredNorm() > 0)) continue;
    LineFit line;
    line.point_mm = a;
    line.direction = (b - a).normalized();
    const Eigen::VectorXd squares = squared_distances(line, points);
    const double bound = close_squared(squares, rounding);
    if (bound >= least) continue;
    least = bound;
    best = line;
    best.points = 2;
    const double close = (squares.array() <= bound).cast<double>().mean();
    // With this share of good ones, as often as kPairs with half.
    pairs =
        std::clamp(kPairs * std::log1p(-0.25) / std::log1p(-close * close), kFewestPairs, pairs);
  }
  return best;
}

/// Sets all but the bend.
bool refine(LineFit& line, const Matrix3Xd& close) {
  line.points = static_cast<std::size_t>(close.cols());
  if (close.cols() < 3) return false;
  line.point_mm = close.rowwise().mean();
  const Matrix3Xd from = close.colwise() - line.point_mm;
  const Eigen::Matrix3d scatter = from * from.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  if (!(solver.eigenvalues()(2) > 0)) return false;
  line.direction = solver.eigenvectors().col(2);
  const Eigen::VectorXd along = from.transpose() * line.direction;
  if (along(along.size() - 1) < along(0)) line.direction = -line.direction;
  line.length_mm = along.maxCoeff() - along.minCoeff();
  line.across_rms_mm =
      std::sqrt(squared_distances(line, close).sum() / 2 / static_cast<double>(close.cols()));
  return true;
}

void set_bend(LineFit& line, const Matrix3Xd& close) {
  constexpr Index kOrders = 3;
  const Index count = close.cols();
  line.bend_sigma_mm = std::numeric_limits<double>::infinity();
  if (count <= kOrders + 1 || !(line.length_mm > 0)) return;
  const Eigen::VectorXd along = (close.colwise() - line.point_mm).transpose() * line.direction;
  const double least = along.minCoeff();
  // Chebyshev polynomials: the second is -1 in the middle and 1 at both ends.
  const Eigen::ArrayXd x = 2 * (along.array() - least) / line.length_mm - 1;
  Eigen::MatrixXd basis(count, kOrders);
  basis << Eigen::VectorXd::Ones(count), x, 2 * x.square() - 1;
  Eigen::MatrixXd off(count, 2);
  for (Index i = 0; i < count; ++i) off.row(i) = across(line, close.col(i)).transpose();
  const Eigen::Matrix3d normal = basis.transpose() * basis;
  const Eigen::LDLT<Eigen::Matrix3d> factors(normal);
  const Eigen::MatrixXd found = factors.solve(basis.transpose() * off);
  const Eigen::MatrixXd left = off - basis * found;
  const double squares = left.squaredNorm();
  const double next = left.topRows(count - 1).cwiseProduct(left.bottomRows(count - 1)).sum();
  const double alike = std::clamp(squares > 0 ? next / squares : 0.0, 0.0, 0.98);
  const double variance = squares / 2 / static_cast<double>(count - kOrders);
  const double of_order = factors.solve(Eigen::Vector3d::UnitZ())(2);
  line.bend_mm = 2 * found.row(2).norm();
  line.bend_sigma_mm = 2 * std::sqrt(variance * of_order * (1 + alike) / (1 - alike));
}

}  // namespace

std::optional<LineFit> fit_line(const Matrix3Xd& points) {
  if (points.cols() < 3 || !points.allFinite()) return std::nullopt;
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * points.cwiseAbs().maxCoeff();
  const Matrix3Xd judges = judges_of(points);
  LineFit line = through_most(judges, rounding);
  if (line.points == 0) return std::nullopt;
  // The line through two points is itself off, and so are the ends of one that is bent: be
  // generous. Twice, since the second line is much better than the first.
  Matrix3Xd close;
  for (int round = 0; round < 2; ++round) {
    const double bound = close_squared(squared_distances(line, judges), rounding);
    const Eigen::VectorXd squares = squared_distances(line, points);
    close.resize(3, points.cols());
    Index count = 0;
    for (Index i = 0; i < points.cols(); ++i)
      if (squares(i) <= bound) close.col(count++) = points.col(i);
    close.conservativeResize(3, count);
    line.within_mm = std::sqrt(bound);
    if (!refine(line, close)) return std::nullopt;
  }
  set_bend(line, close);
  return line;
}

Eigen::Vector2d across(const LineFit& line, const Vector3d& point) {
  return across(line.direction).transpose() * (point - line.point_mm);
}

Matrix6d line_covariance(const LineFit& line, double sigma_mm) {
  const Eigen::Matrix3d off =
      Eigen::Matrix3d::Identity() - line.direction * line.direction.transpose();
  const double variance = sigma_mm * sigma_mm / static_cast<double>(line.points);
  Matrix6d covariance = Matrix6d::Zero();
  // Of evenly spread points the mean square distance from their middle is length^2 / 12.
  covariance.topLeftCorner<3, 3>() = 12 * variance / (line.length_mm * line.length_mm) * off;
  covariance.bottomRightCorner<3, 3>() = variance * off;
  return covariance;
}

}  // namespace identify
