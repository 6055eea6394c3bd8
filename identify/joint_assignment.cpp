#include "identify/joint_assignment.hpp"

#include <algorithm>

#include "identify/circle_fit.hpp"
#include "identify/points.hpp"

namespace identify {
namespace {

using Eigen::Matrix3Xd;

/// Enough points to tell two circles apart.
constexpr Eigen::Index kPoints = 200;

Matrix3Xd thinned(const Matrix3Xd& points) {
  const auto step = std::max<Eigen::Index>(1, points.cols() / kPoints);
  Matrix3Xd few(3, (points.cols() + step - 1) / step);
  for (Eigen::Index i = 0; i < few.cols(); ++i) few.col(i) = points.col(i * step);
  return few;
}

Matrix3Xd joined(const Matrix3Xd& first, const Matrix3Xd& second) {
  Matrix3Xd both(3, first.cols() + second.cols());
  both << first, second;
  return both;
}

double misfit(const CircleFit& circle) {
  return std::max(circle.plane_rms_mm, circle.radial_rms_mm);
}

/// Arcs of one circle fit together as well as each alone; those of two joints, which pass through
/// the same home point about different axes, miss by millimetres.
bool same_circle(const Matrix3Xd& first, const Matrix3Xd& second) {
  const auto one = fit_circle(first);
  const auto other = fit_circle(second);
  const auto both = fit_circle(joined(first, second));
  if (!one || !other || !both) return false;
  constexpr double kSlack_mm = 0.05;
  return misfit(*both) <= kSlack_mm + 2 * std::max(misfit(*one), misfit(*other));
}

}  // namespace

std::size_t assign_joints(std::vector<Sweep>& strokes, const std::vector<DeclaredJoint>& order) {
  std::size_t groups = 0;
  Matrix3Xd group(3, 0);
  Eigen::Vector3d first_normal = Eigen::Vector3d::Zero();
  for (Sweep& stroke : strokes) {
    if (stroke.defect != SweepDefect::none) continue;
    const Matrix3Xd points = thinned(positions(*stroke.samples));
    const auto circle = fit_circle(points);
    if (!circle) continue;
    if (groups == 0 || !same_circle(group, points)) {
      ++groups;
      group = points;
      first_normal = circle->normal;
    } else {
      group = joined(group, points);
    }
    if (groups > order.size()) continue;
    const DeclaredJoint& declared = order[groups - 1];
    stroke.joint = declared.joint;
    const int first = declared.first_direction == 0 ? 1 : declared.first_direction;
    stroke.direction = circle->normal.dot(first_normal) > 0 ? first : -first;
  }
  return groups;
}

}  // namespace identify
