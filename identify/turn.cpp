#include "identify/turn.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "identify/circle_fit.hpp"
#include "identify/points.hpp"

namespace identify {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

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

/// +1 where the points run about the circle's normal, -1 where against it.
double sense_of(const Matrix3Xd& points, const CircleFit& circle) {
  Vector3d turned = Vector3d::Zero();
  for (Eigen::Index i = 1; i < points.cols(); ++i)
    turned += (points.col(i - 1) - circle.center_mm).cross(points.col(i) - points.col(i - 1));
  return turned.dot(circle.normal) < 0 ? -1 : 1;
}

struct Group {
  std::vector<std::size_t> strokes;
  std::vector<Matrix3Xd> points;  // one a stroke
  Matrix3Xd all = Matrix3Xd(3, 0);
};

}  // namespace

std::vector<Turn> turns_in(const std::vector<Sweep>& strokes,
                           const std::vector<std::size_t>& places) {
  std::vector<Group> groups;
  std::size_t newest = 0;
  for (const std::size_t place : places) {
    const Sweep& stroke = strokes[place];
    if (stroke.defect != SweepDefect::none) continue;
    const Matrix3Xd points = thinned(positions(*stroke.samples));
    if (!fit_circle(points)) continue;
    const auto is_its = [&](const Group& group) { return same_circle(group.all, points); };
    // The one that was under way, as a rule.
    if (groups.empty() || !is_its(groups[newest]))
      newest = static_cast<std::size_t>(std::find_if(groups.begin(), groups.end(), is_its) -
                                        groups.begin());
    if (newest == groups.size()) groups.emplace_back();
    Group& group = groups[newest];
    group.strokes.push_back(place);
    group.points.push_back(points);
    group.all = group.all.cols() < 4 * kPoints ? joined(group.all, points) : group.all;
  }
  std::vector<Turn> turns;
  for (const Group& group : groups) {
    const auto circle = fit_circle(group.all);
    if (!circle) continue;
    Turn turn{group.strokes, {}, {circle->normal, circle->center_mm, {}}};
    turn.axis.covariance =
        axis_covariance(*circle, group.all, circle->plane_rms_mm, circle->radial_rms_mm);
    for (std::size_t s = 0; s < group.strokes.size(); ++s)
      turn.angles_rad.push_back(sense_of(group.points[s], *circle) *
                                strokes[group.strokes[s]].range_rad);
    turns.push_back(std::move(turn));
  }
  return turns;
}

}  // namespace identify
