#include "identify/sweeps/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/symmetric_eigen.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/stroke_groups.hpp"

namespace identify {

std::string_view remedy(SweepDefect defect, bool linear) noexcept {
  switch (defect) {
    case SweepDefect::too_short:
      return linear ? "its strokes are shorter than 5 mm: move it further"
                    : "its arcs are shorter than 5°: sweep it further";
    case SweepDefect::too_few_samples:
      return "its sweeps have too few samples: move it slower, or measure more points";
    case SweepDefect::other_joint_moved:
      return "another joint moved along by more than 0.03°: move one joint at a time";
    case SweepDefect::not_an_arc:
      return linear ? "its positions do not lie on a line" : "its positions do not lie on a circle";
    case SweepDefect::none:
      break;
  }
  return "";
}

std::string_view code(SweepDefect defect) noexcept {
  switch (defect) {
    case SweepDefect::too_short:
      return "sweep_too_short";
    case SweepDefect::too_few_samples:
      return "too_few_samples";
    case SweepDefect::other_joint_moved:
      return "other_joint_moved";
    case SweepDefect::not_an_arc:
      return "not_an_arc";
    case SweepDefect::none:
      break;
  }
  return "";
}

namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A stroke that paused goes on from where it was, but for what is slower than motion.
constexpr double kPaused_rad = 1 * kDegree;
/// Turned about the circle, unwrapped. A point that is beside it stands where the one before it
/// did.
std::vector<double> turns_about(const CircleFit& circle, const Matrix3Xd& points) {
  constexpr double kBeside = 10;  // root mean squares
  constexpr double kRounding = 1e-6;
  const double most_mm = std::max(kBeside * std::hypot(circle.plane_rms_mm, circle.radial_rms_mm),
                                  kRounding * circle.radius_mm);
  const Vector3d across = circle.normal.unitOrthogonal();
  const Vector3d up = circle.normal.cross(across);
  std::vector<double> turns;
  std::optional<double> last;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d from = points.col(i) - circle.center_mm;
    const CircleResidual off = residual(circle, points.col(i));
    if (std::hypot(off.plane_mm, off.radial_mm) <= most_mm) {
      const double angle = std::atan2(up.dot(from), across.dot(from));
      last = last ? *last + std::remainder(angle - *last, 2 * kPi) : angle;
    }
    if (last) turns.push_back(*last);
  }
  if (last)
    turns.insert(turns.begin(), static_cast<std::size_t>(points.cols()) - turns.size(),
                 turns.front());
  return turns;
}

/// Noise as a share of how far points depart from a line. Linear least squares take the circle's
/// radius for smaller by it (of eq. 6, y is not exact, either: errors in variables), and so every
/// angle for larger.
double noise_in_bend(const Matrix3Xd& points) {
  const Matrix3Xd centred = points.colwise() - Vector3d(points.rowwise().mean());
  const Eigen::Matrix3d squares = centred * centred.transpose();
  const Vector3d extents = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squares).eigenvalues();
  return extents(1) > 0 ? std::clamp(extents(0) / extents(1), 0.0, 1.0) : 1;
}

}  // namespace

std::vector<Turn> turns_in(const std::vector<Sweep>& strokes,
                           const std::vector<std::size_t>& places, std::size_t joints) {
  std::vector<Turn> turns;
  for (const StrokeGroup& group : stroke_groups(strokes, places, joints)) {
    const auto circle = fit_circle(group.all);
    if (!circle) continue;
    Turn turn{{}, noise_in_bend(group.all), {circle->normal, circle->center_mm, {}}};
    turn.axis.covariance =
        axis_covariance(*circle, group.all, circle->plane_rms_mm, circle->radial_rms_mm);
    // A short stroke alone tells the middle of its circle badly, and so by which angle it turned.
    std::optional<double> ended_rad;
    for (std::size_t s = 0; s < group.strokes.size(); ++s) {
      const Sweep& seen = strokes[group.strokes[s]];
      const auto angles = turns_about(*circle, group.points[s]);
      Turn::Stroke stroke{group.strokes[s], seen.first().time_s, 0,
                          seen.begin_seen,  seen.end_seen,       {}};
      if (!angles.empty()) {
        stroke.angle_rad = (1 - turn.unsure) * (angles.back() - angles.front());
        if (ended_rad && stroke.angle_rad * turn.strokes.back().angle_rad > 0) {
          const double gap = std::remainder(angles.front() - *ended_rad, 2 * kPi);
          if (!seen.begin_seen && !turn.strokes.back().end_seen && stroke.angle_rad * gap > 0)
            stroke.gap_rad = gap;
          stroke.goes_on = std::abs(gap) < kPaused_rad;
        }
        ended_rad = angles.back();
      }
      turn.strokes.push_back(stroke);
    }
    turns.push_back(std::move(turn));
  }
  return turns;
}

namespace {

constexpr double kSway_rad = 2 * kDegree;
constexpr double kSway_mm = 2;  // of a linear joint
constexpr double kFewestInStroke = 4;
/// What goes back by more than so many usual steps from one sample to the next was not seen to. An
/// arc of more than a half circle looks as if it went on from there.
constexpr double kUnseenSteps = 5;
constexpr double kUnseen_rad = kPi / 4;

/// Of each number, and of up to two before and behind it: a stray one is passed over.
std::vector<double> running_medians(const std::vector<double>& numbers) {
  constexpr std::size_t kBeside = 2;
  std::vector<double> medians;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t beside = std::min({kBeside, i, numbers.size() - 1 - i});
    const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(i - beside);
    medians.push_back(median_of({begin, begin + static_cast<std::ptrdiff_t>(2 * beside + 1)}));
  }
  return medians;
}

/// How far a motion has gone at each point, on its circle (rad) or, of less than a sway of that, on
/// its line (mm).
struct Way {
  std::vector<double> gone;
  double sway = 0;
  double goes_on_unseen = 0;  ///< what goes on by more in one step was not seen to
};

double range_of(const std::vector<double>& numbers) {
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  return numbers.empty() ? 0 : *most - *least;
}

Way way_of(const Matrix3Xd& points) {
  constexpr double kNoises = 6;
  if (const auto circle = fit_robust_circle(points)) {
    Way way{running_medians(turns_about(*circle, points)), 0, kUnseen_rad};
    way.sway = std::max(kSway_rad, kNoises * circle->radial_rms_mm / circle->radius_mm);
    if (range_of(way.gone) > kSway_rad) return way;
  }
  const Matrix3Xd centred = points.colwise() - Vector3d(points.rowwise().mean());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centred * centred.transpose());
  const Eigen::VectorXd along = centred.transpose() * axes.eigenvectors().col(2);
  const double across_mm =
      std::sqrt(std::max(0.0, axes.eigenvalues()(1)) / static_cast<double>(points.cols()));
  return {running_medians({along.begin(), along.end()}), std::max(kSway_mm, kNoises * across_mm),
          std::numeric_limits<double>::infinity()};
}

/// The middle between where a motion came near its farthest point and where it left that: medians
/// are level there. Two samples of the stroke before would bend the next one's arc.
std::size_t middle_of_turn(const Way& way, std::size_t farthest) {
  const auto is_near = [&](std::size_t i) {
    return std::abs(way.gone[i] - way.gone[farthest]) < way.sway / 2;
  };
  std::size_t before = farthest, behind = farthest;
  while (before > 0 && is_near(before)) --before;
  while (behind + 1 < way.gone.size() && is_near(behind)) ++behind;
  return (before + behind + 1) / 2;
}

}  // namespace

std::vector<std::size_t> turning_points(const std::vector<Sample>& samples) {
  const auto points = positions(samples);
  if (samples.empty() || static_cast<std::size_t>(points.cols()) != samples.size()) return {};
  const Way motion = way_of(points);
  const std::vector<double>& turns = motion.gone;
  std::vector<double> steps;
  for (std::size_t i = 1; i < turns.size(); ++i) steps.push_back(std::abs(turns[i] - turns[i - 1]));
  const double unseen = std::max(motion.sway, kUnseenSteps * median_of(steps));
  std::vector<std::size_t> found;
  // The farthest point of the stroke under way; the stroke has ended once the motion came back from
  // it by more than a sway. Where it came back unseen, the next one begins there, either way.
  std::size_t farthest = 0, nearest = 0;
  int way = 0;
  for (std::size_t i = 1; i < turns.size(); ++i) {
    const double step = way * (turns[i] - turns[i - 1]);
    if (step < -unseen || step > std::max(unseen, motion.goes_on_unseen)) {
      found.push_back(i);
      farthest = nearest = i;
      way = 0;
    }
    if (way >= 0 && turns[i] > turns[farthest]) farthest = i;
    if (way <= 0 && turns[i] < turns[nearest]) nearest = i;
    if (way == 0) {
      if (turns[i] - turns[nearest] > motion.sway) way = 1;
      if (turns[farthest] - turns[i] > motion.sway) way = -1;
    } else if (way > 0 && turns[farthest] - turns[i] > motion.sway) {
      found.push_back(middle_of_turn(motion, farthest));
      nearest = i;
      way = -1;
    } else if (way < 0 && turns[i] - turns[nearest] > motion.sway) {
      found.push_back(middle_of_turn(motion, nearest));
      farthest = i;
      way = 1;
    }
  }
  const auto strokes = static_cast<double>(found.size() + 1);
  if (static_cast<double>(samples.size()) < kFewestInStroke * strokes) found.clear();
  return found;
}

}  // namespace identify
