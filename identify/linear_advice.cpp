#include "identify/linear_advice.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/advice.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/plausibility.hpp"
#include "identify/sweeps/linear_joint.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {
namespace {

constexpr double kLinearSigmas = 4;

std::string way(double turn_rad) {
  return brief(kLinear_mm * turn_rad) + " mm";
}

}  // namespace

std::vector<Warning> advice_of_linear(const Identification& found, std::size_t j,
                                      const Resolution& resolution) {
  std::vector<Warning> advice;
  const auto warn = [&](const char* code, const std::string& text) {
    advice.push_back({code, j, joint_name(j) + ": " + text});
  };
  const JointResult& joint = found.joints[j];
  const double sigma = joint.axis ? joint.axis->direction_sigma_rad() : 0;
  if (!joint.axis || sigma > kPoorDirection_rad) {
    std::string remedy = "move it further";
    // Of as many samples a line's direction is known as the inverse of its length.
    if (joint.axis)
      remedy += ", " + fixed(joint.line->length_mm * sigma / kPoorDirection_rad, 0) +
                " mm would give about " + brief(kPoorDirection_rad / kDegree) + "°";
    warn("stroke_short",
         "its strokes determine its direction poorly (length " + fixed(joint.line->length_mm, 1) +
             " mm, direction uncertain by " +
             (joint.axis ? brief(sigma / kDegree) + "°" : std::string("more than 1°")) +
             "): " + remedy);
  }
  if (!found.chain || found.chain->angles[j].samples == 0) return advice;
  const AngleEvidence& seen = found.chain->angles[j];
  const double backlash = std::abs(seen.backlash_rad);
  if (seen.backlash_sigma_rad > 0 && backlash > resolution.angle_rad &&
      backlash > kLinearSigmas * seen.backlash_sigma_rad)
    warn("backlash", "its error depends on the direction of the motion, by " + way(backlash) +
                         ": move it in one direction only, or look after the drive");
  if (seen.trust == AngleTrust::free)
    warn("angles_not_used", "its mm were not used, each of its lines stands by its points alone: " +
                                seen.reason + " (error " + way(seen.error_rms_rad) + " rms, " +
                                way(seen.expected_rms_rad) + " expected)");
  return advice;
}

namespace {

/// Drives err by hundredths of a per cent.
constexpr double kWrongWay_mm = 1;
constexpr double kWrongWayShare = 0.01;

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

/// `late_s`: how late its mm may have come, which leaves their ends out.
std::optional<Warning> went_elsewhere(const LineFit& line, const std::vector<Sweep>& used,
                                      std::size_t joint, double late_s) {
  const ToldWay told = told_way(line, used, joint);
  const double way_mm = kLinear_mm * told.range_rad;
  const double seen_mm = way_mm * std::abs(told.mm_per_unit);
  double fastest_mm_s = 0;
  for (const Sweep& sweep : used) {
    const double seconds = sweep.last().time_s - sweep.first().time_s;
    if (seconds > 0) fastest_mm_s = std::max(fastest_mm_s, way_mm / seconds);
  }
  const double late_mm = late_s * fastest_mm_s;
  if (!(std::abs(seen_mm - way_mm) > std::max(kWrongWay_mm, kWrongWayShare * way_mm) + late_mm))
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
    const double late_s = found.delay ? std::abs(found.delay->late_s) : 0;
    if (!doubt) doubt = went_elsewhere(*joint.line, used, j, late_s);
    if (doubt) found.doubts.push_back(*std::move(doubt));
  }
}

}  // namespace identify
