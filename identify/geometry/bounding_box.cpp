#include "identify/geometry/bounding_box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "identify/geometry/box_search.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kFlat = 1e-10;  // of the largest extent
constexpr double kRough = 0.01;  // gap of the first search, which only turns the points
constexpr double kFine = 1e-12;

// Each point once, in an order of their own.
Matrix3Xd distinct(const Matrix3Xd& points) {
  std::vector<Vector3d> list(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = points.col(static_cast<Index>(i));
  std::sort(list.begin(), list.end(), [](const Vector3d& a, const Vector3d& b) {
    return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
  });
  list.erase(std::unique(list.begin(), list.end()), list.end());
  Matrix3Xd result(3, static_cast<Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) result.col(static_cast<Index>(i)) = list[i];
  return result;
}

struct PrincipalFrame {
  Matrix3d axes = Matrix3d::Identity();
  int rank = 0;
  double least_width = 0;  // no direction within the rank has less
};

// A tetrahedron of far points: the farthest from the first, from the line through both, and from
// the plane through the three. Its edges say how far the set extends, and give the frame.
PrincipalFrame frame_of(const Matrix3Xd& points, double flat) {
  PrincipalFrame frame;
  Index far = 0;
  const Matrix3Xd from_first = points.colwise() - points.col(0);
  const double length = std::sqrt(from_first.colwise().squaredNorm().maxCoeff(&far));
  if (!(length > flat)) return frame;
  frame.rank = 1;
  Matrix3d edges = Matrix3d::Zero();
  edges.col(0) = from_first.col(far);
  const Vector3d x = edges.col(0) / length;

  const Matrix3Xd from_line = from_first - x * (x.transpose() * from_first);
  const double breadth = std::sqrt(from_line.colwise().squaredNorm().maxCoeff(&far));
  Vector3d y = x.unitOrthogonal();
  if (breadth > flat) {
    frame.rank = 2;
    edges.col(1) = from_first.col(far);
    y = from_line.col(far);
    y = (y - x * x.dot(y)).normalized();
  }
  frame.axes << x, y, x.cross(y);

  const Eigen::RowVectorXd heights = frame.axes.col(2).transpose() * from_first;
  const double height = heights.cwiseAbs().maxCoeff(&far);
  if (frame.rank == 2 && height > flat) {
    frame.rank = 3;
    edges.col(2) = from_first.col(far);
  }
  // The width in direction u is at least |edge . u| for every edge, hence at least
  // |edges^T u| / sqrt(rank).
  edges = frame.axes.transpose() * edges;
  // Directions that the set does not have are none of the least wide.
  for (int k = frame.rank; k < 3; ++k) edges(k, k) = length;
  const Vector3d widths = edges.jacobiSvd().singularValues();
  frame.least_width = widths(2) / std::sqrt(frame.rank);
  return frame;
}

// A sign that neither rounding nor a tie of two components can turn round.
double sign_of(const Vector3d& axis) {
  const double large = (1 - 1e-6) * axis.cwiseAbs().maxCoeff();
  for (const double component : axis) {
    if (std::abs(component) >= large) return component < 0 ? -1 : 1;
  }
  return 1;
}

}  // namespace

std::optional<BoundingBox> minimum_bounding_box(const Matrix3Xd& points_mm) {
  if (points_mm.cols() == 0 || !points_mm.allFinite()) return std::nullopt;
  const Matrix3Xd points = distinct(points_mm);

  // From here on in units of the size of the set, about its middle.
  const Vector3d low = points.rowwise().minCoeff() / 2;
  const Vector3d high = points.rowwise().maxCoeff() / 2;
  const Vector3d middle = low + high;
  const double size = std::max((high - low).maxCoeff(), std::numeric_limits<double>::min());
  const Matrix3Xd unit = (points.colwise() - middle) / size;
  const double rounding = std::numeric_limits<double>::epsilon() *
                          std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()) / size;

  const PrincipalFrame frame = frame_of(unit, std::max(kFlat, 8 * rounding));
  Matrix3d axes = frame.axes;
  double log_gap = 0;
  if (frame.rank >= 2) {
    Eigen::Matrix<double, Eigen::Dynamic, 3> in_frame = unit.transpose() * frame.axes;
    if (frame.rank == 2) in_frame.col(2).setZero();
    for (const double tolerance : {kRough, kFine}) {
      const BoxSearch search = search_box(in_frame, frame.rank, frame.least_width, tolerance);
      in_frame *= search.axes;
      axes *= search.axes;
      log_gap = search.gap;
    }
  }

  const Matrix3Xd along = axes.transpose() * unit;
  const Vector3d front = along.rowwise().maxCoeff();
  const Vector3d back = along.rowwise().minCoeff();
  const Vector3d lengths = front - back;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return lengths(a) > lengths(b); });

  BoundingBox box;
  for (int i = 0; i < 3; ++i) {
    const int from = order[static_cast<std::size_t>(i)];
    box.lengths_mm(i) = size * lengths(from);
    box.orientation.col(i) = axes.col(from);
  }
  for (int i = 0; i < 2; ++i) box.orientation.col(i) *= sign_of(box.orientation.col(i));
  box.orientation.col(2) = box.orientation.col(0).cross(box.orientation.col(1));
  box.center_mm = middle + size * (axes * ((front + back) / 2));
  box.gap = std::expm1(log_gap);
  return box;
}

}  // namespace identify
