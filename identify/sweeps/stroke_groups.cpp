#include "identify/sweeps/stroke_groups.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "identify/geometry/circle_fit.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// By how much strokes of one joint may miss each other.
constexpr std::array kSlacks_mm{0.05, 0.1, 0.2, 0.4, 0.8};
/// Enough points to tell two circles apart.
constexpr Eigen::Index kPoints = 200;

Matrix3Xd thinned(const Matrix3Xd& points) {
  const auto step = std::max<Eigen::Index>(1, points.cols() / kPoints);
  Matrix3Xd few(3, (points.cols() + step - 1) / step);
  for (Eigen::Index i = 0; i < few.cols(); ++i) few.col(i) = points.col(i * step);
  if (few.cols() > 0) few.rightCols<1>() = points.rightCols<1>();  // all of the turn
  return few;
}

void leave_strays(Matrix3Xd& points, const UsualCircle& usual) {
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const CircleResidual off = residual(usual.circle, points.col(i));
    if (std::hypot(off.plane_mm, off.radial_mm) <= usual.within_mm)
      points.col(count++) = points.col(i);
  }
  points.conservativeResize(Eigen::NoChange, count);
}

Matrix3Xd joined(const Matrix3Xd& first, const Matrix3Xd& second) {
  Matrix3Xd both(3, first.cols() + second.cols());
  both << first, second;
  return both;
}

double misfit(const CircleFit& circle) {
  return std::max(circle.plane_rms_mm, circle.radial_rms_mm);
}

double misfit(const CircleFit& circle, const Matrix3Xd& points) {
  double plane = 0, radial = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const CircleResidual off = residual(circle, points.col(i));
    plane += off.plane_mm * off.plane_mm;
    radial += off.radial_mm * off.radial_mm;
  }
  return std::sqrt(std::max(plane, radial) /
                   static_cast<double>(std::max<Eigen::Index>(1, points.cols())));
}

/// How far the points' middle is from the line through their ends.
double bend_mm(const Matrix3Xd& points) {
  const Vector3d chord = (points.rightCols<1>() - points.leftCols<1>()).normalized();
  return chord.cross(points.col(points.cols() / 2) - points.col(0)).norm();
}

/// Arcs of one circle fit together as well as each alone; those of two joints, which pass through
/// the same home point about different axes, miss by millimetres: also a short one beside many
/// others, which make little of it. Homes and devices that moved miss by less, but for long arms,
/// of which `slack_mm` may be more as far as both bend much more.
bool same_circle(const StrokeGroup& first, const StrokeGroup& second, double slack_mm) {
  constexpr double kOfBend = 0.01, kOfOne = 6;
  const auto both = fit_circle(joined(first.all, second.all));
  const double bent_mm = std::min(bend_mm(first.points.front()), bend_mm(second.points.front()));
  slack_mm = std::clamp(kOfBend * bent_mm, kSlacks_mm.front(), slack_mm);
  const double twice_mm = 2 * std::max(first.misfit_mm, second.misfit_mm);
  return both && misfit(*both) <= slack_mm + twice_mm &&
         std::max(misfit(*both, first.all), misfit(*both, second.all)) <=
             kOfOne * slack_mm + twice_mm;
}

void add(const StrokeGroup& more, StrokeGroup& group) {
  group.strokes.insert(group.strokes.end(), more.strokes.begin(), more.strokes.end());
  group.points.insert(group.points.end(), more.points.begin(), more.points.end());
  if (group.all.cols() >= 4 * kPoints) return;
  group.all = joined(group.all, more.all);
  const auto circle = fit_circle(group.all);
  group.misfit_mm = circle ? misfit(*circle) : group.misfit_mm;
}

/// Groups to which the motion came back later are one. Of motion that never does so only the first
/// `most` count: so the time is in proportion to the number of groups.
std::vector<StrokeGroup> returned(const std::vector<StrokeGroup>& groups, std::size_t most,
                                  double slack_mm) {
  std::vector<StrokeGroup> whole;
  for (const StrokeGroup& group : groups) {
    const auto same = std::find_if(whole.begin(), whole.end(), [&](const StrokeGroup& known) {
      return same_circle(known, group, slack_mm);
    });
    if (same != whole.end())
      add(group, *same);
    else if (whole.size() < most)
      whole.push_back(group);
  }
  return whole;
}

std::vector<StrokeGroup> followed(const std::vector<StrokeGroup>& strokes, double slack_mm) {
  std::vector<StrokeGroup> groups;
  for (const StrokeGroup& stroke : strokes)
    if (groups.empty() || !same_circle(groups.back(), stroke, slack_mm))
      groups.push_back(stroke);
    else
      add(stroke, groups.back());
  return groups;
}

/// With no more slack than makes as many groups as there are joints at most.
std::vector<StrokeGroup> grouped(const std::vector<StrokeGroup>& strokes, std::size_t joints) {
  std::vector<StrokeGroup> first, whole;  // those of the least slack
  for (const double slack_mm : kSlacks_mm) {
    auto groups = followed(strokes, slack_mm);
    if (groups.size() <= joints) return groups;
    if (first.empty()) first = std::move(groups);
  }
  for (const double slack_mm : kSlacks_mm) {
    auto groups = returned(first, 2 * joints, slack_mm);
    if (groups.size() <= joints) return groups;
    if (whole.empty()) whole = std::move(groups);
  }
  return whole;
}

}  // namespace

std::vector<StrokeGroup> stroke_groups(const std::vector<Sweep>& strokes,
                                       const std::vector<std::size_t>& places, std::size_t joints) {
  std::vector<StrokeGroup> alone;
  for (const std::size_t place : places) {
    const Sweep& stroke = strokes[place];
    if (stroke.defect != SweepDefect::none) continue;
    Matrix3Xd points = thinned(positions(*stroke.samples));
    const auto usual = fit_usual_circle(points);
    if (!usual) continue;
    leave_strays(points, *usual);
    alone.push_back({{place}, {points}, points, misfit(usual->circle)});
  }
  return grouped(alone, joints);
}

}  // namespace identify
