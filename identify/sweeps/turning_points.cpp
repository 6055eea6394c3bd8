#include "identify/sweeps/turning_points.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/robust_circle.hpp"
#include "identify/sweeps/points.hpp"

namespace identify {
namespace {

constexpr double kSway_rad = 2 * kDegree;
constexpr double kFewestInStroke = 4;

/// Turned about the circle, unwrapped.
std::vector<double> turns_about(const CircleFit& circle, const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d across = circle.normal.unitOrthogonal();
  const Eigen::Vector3d up = circle.normal.cross(across);
  std::vector<double> turns;
  double last = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d from = points.col(i) - circle.center_mm;
    const double angle = std::atan2(up.dot(from), across.dot(from));
    last = turns.empty() ? angle : last + std::remainder(angle - last, 2 * kPi);
    turns.push_back(last);
  }
  return turns;
}

}  // namespace

std::vector<std::size_t> turning_points(const std::vector<Sample>& samples) {
  const auto points = positions(samples);
  if (static_cast<std::size_t>(points.cols()) != samples.size()) return {};
  const auto circle = fit_robust_circle(points);
  if (!circle) return {};
  const double noise = circle->radial_rms_mm / circle->radius_mm;
  const double sway = std::max(kSway_rad, 6 * noise);
  const auto turns = turns_about(*circle, points);
  std::vector<std::size_t> found;
  // The farthest point of the stroke under way; the stroke has ended once the motion came back from
  // it by more than a sway.
  std::size_t farthest = 0, nearest = 0;
  int way = 0;
  for (std::size_t i = 1; i < turns.size(); ++i) {
    if (way >= 0 && turns[i] > turns[farthest]) farthest = i;
    if (way <= 0 && turns[i] < turns[nearest]) nearest = i;
    if (way == 0) {
      if (turns[i] - turns[nearest] > sway) way = 1;
      if (turns[farthest] - turns[i] > sway) way = -1;
    } else if (way > 0 && turns[farthest] - turns[i] > sway) {
      found.push_back(farthest);
      nearest = i;
      way = -1;
    } else if (way < 0 && turns[i] - turns[nearest] > sway) {
      found.push_back(nearest);
      farthest = i;
      way = 1;
    }
  }
  const auto strokes = static_cast<double>(found.size() + 1);
  if (static_cast<double>(samples.size()) < kFewestInStroke * strokes) found.clear();
  return found;
}

}  // namespace identify
