#include "identify/sweeps/linear_joint.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/segmentation.hpp"

namespace identify {
namespace {

constexpr double kStraightSigmas = 4;
constexpr double kSameWay = 0.01;
constexpr double kLongestArm_mm = 10'000;
/// An arc by a longer one, in wrong units perhaps, is bent by so much of its length; rails are not.
constexpr double kMostBend = 0.05;

}  // namespace

ToldWay told_way(const LineFit& line, const std::vector<Sweep>& sweeps, std::size_t joint) {
  // Far points say nothing: what is along the line is theirs by chance.
  const double near = 6 * line.across_rms_mm + 1e-6;
  double together = 0, squares = 0;
  ToldWay told;
  for (const Sweep& sweep : sweeps) {
    std::vector<const Sample*> good;
    double mean_told = 0, mean_along = 0;
    const auto along = [&](const Sample& sample) {
      return line.direction.dot(sample.position_mm - line.point_mm);
    };
    for (const Sample& sample : *sweep.samples) {
      if (!sample.has_position || sample.joints <= joint) continue;
      if (across(line, sample.position_mm).norm() > near) continue;
      good.push_back(&sample);
      mean_told += sample.angles_rad[joint];
      mean_along += along(sample);
    }
    if (good.empty()) continue;
    mean_told /= static_cast<double>(good.size());
    mean_along /= static_cast<double>(good.size());
    double least = mean_told, most = mean_told;
    for (const Sample* sample : good) {
      const double angle = sample->angles_rad[joint] - mean_told;
      together += angle * (along(*sample) - mean_along);
      squares += angle * angle;
      least = std::min(least, sample->angles_rad[joint]);
      most = std::max(most, sample->angles_rad[joint]);
    }
    told.range_rad = std::max(told.range_rad, most - least);
  }
  if (squares > 0) told.mm_per_unit = together / squares / kLinear_mm;
  return told;
}

Straightness straightness(const LineFit& line, const ToldWay& told) {
  const bool with_angles = told.range_rad > 0;
  if (with_angles && std::abs(std::abs(told.mm_per_unit) - 1) > kSameWay) return Straightness::bent;
  const double sagitta =
      with_angles ? line.length_mm / 2 * std::tan(std::min(told.range_rad, kPi) / 4)
                  : line.length_mm * std::min(line.length_mm / (8 * kLongestArm_mm), kMostBend);
  const double room = kStraightSigmas * line.bend_sigma_mm;
  if (line.bend_mm + room < sagitta / 2) return Straightness::straight;
  return line.bend_mm - room > sagitta / 2 ? Straightness::bent : Straightness::undecided;
}

LinearVerdict linear_verdict(const Eigen::Matrix3Xd& points, const std::vector<Sweep>& used,
                             std::size_t joint, std::optional<bool> described_linear) {
  LinearVerdict verdict;
  const auto line = fit_line(points);
  if (!line) return verdict;
  ToldWay told = told_way(*line, used, joint);
  // What is described as linear and goes another way than told is not an arc for that.
  if (described_linear == true) told.mm_per_unit = 1;
  const Straightness seen = straightness(*line, told);
  const bool linear = seen == Straightness::straight ||
                      (described_linear == true && seen == Straightness::undecided);
  if (linear) verdict.line = line;
  if (described_linear && *described_linear != linear)
    verdict.contradiction =
        joint_name(joint) +
        (linear ? ": the robot description says that it turns, but its target moved along a "
                  "straight line: give it type = \"linear\" if it is a linear joint"
                : ": the robot description says that it is linear, but its target moved on an arc: "
                  "check that the description is this robot's");
  return verdict;
}

Sweep judged_as_line(Sweep sweep, bool known_linear) {
  const bool told = sweep.first().joints > 0;
  const bool as_arc =
      sweep.defect == SweepDefect::not_an_arc || (sweep.defect == SweepDefect::too_short && !told);
  if (!as_arc) return sweep;
  const auto line = fit_line(positions(*sweep.samples));
  if (!line || !(known_linear || straightness(*line, {}) == Straightness::straight)) return sweep;
  if (!told) sweep.range_rad = line->length_mm / kLinear_mm;
  sweep.defect = sweep.range_rad < kShortestRange_rad ? SweepDefect::too_short : SweepDefect::none;
  return sweep;
}

}  // namespace identify
