#include "identify/linear_plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/geometry/number_text.hpp"
#include "identify/plausibility.hpp"
#include "identify/sweeps/linear_joint.hpp"
#include "identify/sweeps/points.hpp"

namespace identify {
namespace {

/// Drives err by hundredths of a per cent.
constexpr double kWrongWay_mm = 1;
constexpr double kWrongWayShare = 0.01;

std::vector<Sweep> used_sweeps(const JointResult& joint) {
  std::vector<Sweep> used;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
    if (joint.used[s] && joint.sweeps[s].target == joint.circle_target)
      used.push_back(joint.sweeps[s]);
  return used;
}

double sigma_rad(const LineFit& line) {
  return std::sqrt(line_covariance(line, line.across_rms_mm).topLeftCorner<3, 3>().trace() / 2);
}

std::optional<Warning> lines_disagree(const std::vector<Sweep>& used, std::size_t joint) {
  std::optional<LineFit> first;
  for (const Sweep& sweep : used) {
    const auto line = fit_line(positions(*sweep.samples));
    if (!line) continue;
    if (!first) {
      first = line;
      continue;
    }
    const double apart_mm = across(*first, line->point_mm).norm();
    const double sine = line->direction.cross(first->direction).norm();
    const double apart_rad = std::asin(std::min(1.0, sine));
    const double sure_rad = kApartSigmas * std::hypot(sigma_rad(*first), sigma_rad(*line));
    if (!(apart_mm > kApart_mm) && !(apart_rad > kApart_rad + sure_rad)) continue;
    return Warning{"strokes_disagree", joint,
                   joint_name(joint) + ": its strokes do not run along one line: they are " +
                       fixed(apart_mm, 1) + " mm apart, their directions " +
                       fixed(apart_rad / kDegree, 1) +
                       "°: something else moved between them, or one is another joint's"};
  }
  return std::nullopt;
}

std::optional<Warning> is_no_line(const LineFit& line, std::size_t joint) {
  if (!(std::max(line.across_rms_mm, line.bend_mm) > kOffCurve_mm)) return std::nullopt;
  return Warning{"line_misfit", joint,
                 joint_name(joint) + ": its points lie on no straight line: they are " +
                     fixed(line.across_rms_mm, 1) + " mm off it, and bend by " +
                     fixed(line.bend_mm, 1) +
                     " mm: another joint moved along, or points of other places are among them"};
}

std::optional<Warning> went_elsewhere(const LineFit& line, const std::vector<Sweep>& used,
                                      std::size_t joint) {
  const ToldWay told = told_way(line, used, joint);
  const double way_mm = kLinear_mm * told.range_rad;
  const double seen_mm = way_mm * std::abs(told.mm_per_unit);
  if (!(std::abs(seen_mm - way_mm) > std::max(kWrongWay_mm, kWrongWayShare * way_mm)))
    return std::nullopt;
  return Warning{"angle_arc_mismatch", joint,
                 joint_name(joint) + ": while it was told to have moved by " + fixed(way_mm, 1) +
                     " mm, the target was seen to move by " + fixed(seen_mm, 1) +
                     " mm: the numbers told are not this joint's mm, or not of these positions"};
}

}  // namespace

void judge_linear_joints(Identification& found) {
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const JointResult& joint = found.joints[j];
    if (!joint.line) continue;
    const auto used = used_sweeps(joint);
    auto doubt = lines_disagree(used, j);
    if (!doubt) doubt = is_no_line(*joint.line, j);
    if (!doubt) doubt = went_elsewhere(*joint.line, used, j);
    if (doubt) found.doubts.push_back(*std::move(doubt));
  }
}

}  // namespace identify
