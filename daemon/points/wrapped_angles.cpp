#include "daemon/points/wrapped_angles.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

constexpr double kTurn_rad = 2 * kPi;
/// From one point of a sweep to the next a joint turns by less.
const double kLargestStep_rad = radians(30);
/// A joint that passes the end of the circle is never in a part that is larger than this.
const double kOpenPart_rad = radians(90);
/// Of rounding.
const double kRounding_rad = radians(0.01);

/// All angles that are told of one joint.
struct Told {
  std::vector<double> angles_rad;
  bool jumps = false;

  [[nodiscard]] bool lie_from(double least_rad) const {
    return angles_rad.front() >= least_rad - kRounding_rad &&
           angles_rad.back() <= least_rad + kTurn_rad + kRounding_rad;
  }
};

Told told_of(const std::vector<PointsFile>& files, std::size_t joint) {
  Told told;
  for (const PointsFile& file : files) {
    std::map<std::size_t, const Point*> before;  // by target
    for (const Point& point : file.points) {
      if (point.sample.joints <= joint) continue;
      const double angle = point.sample.angles_rad[joint];
      told.angles_rad.push_back(angle);
      const Point*& last = before[point.target];
      if (last != nullptr && last->joint == point.joint && last->sweep == point.sweep)
        told.jumps = told.jumps || std::abs(angle - last->sample.angles_rad[joint]) >
                                       kTurn_rad - kLargestStep_rad;
      last = &point;
    }
  }
  std::sort(told.angles_rad.begin(), told.angles_rad.end());
  return told;
}

/// The last angle before the largest part of the circle in which the joint never is; nothing where
/// that is at the circle's end anyway, or small.
std::optional<double> end_of_circle(const std::vector<double>& angles_rad) {
  double open_rad = std::max(kOpenPart_rad, kTurn_rad - (angles_rad.back() - angles_rad.front()));
  std::optional<double> end;
  for (std::size_t k = 1; k < angles_rad.size(); ++k) {
    const double part_rad = angles_rad[k] - angles_rad[k - 1];
    if (part_rad <= open_rad) continue;
    open_rad = part_rad;
    end = angles_rad[k - 1];
  }
  return end;
}

/// Turns so that the angles up to `end_rad`, and those beyond it less a turn, lie about 0.
void turn(std::vector<PointsFile>& files, std::size_t joint, double end_rad,
          const std::vector<double>& angles_rad) {
  const auto beyond = std::upper_bound(angles_rad.begin(), angles_rad.end(), end_rad);
  const double first_rad = beyond == angles_rad.end() ? angles_rad.front() : *beyond - kTurn_rad;
  const double turns = (first_rad + end_rad - kRounding_rad) / 2 / kTurn_rad;
  const double whole_rad = kTurn_rad * std::ceil(turns - 0.5);  // 180 degrees stay so
  for (PointsFile& file : files)
    for (Point& point : file.points) {
      if (point.sample.joints <= joint) continue;
      double& angle = point.sample.angles_rad[joint];
      angle -= whole_rad + (angle > end_rad ? kTurn_rad : 0);
    }
}

}  // namespace

std::vector<std::size_t> take_out_turns(std::vector<PointsFile>& files) {
  const auto is_linear = [&](std::size_t j) {
    return std::any_of(files.begin(), files.end(),
                       [&](const PointsFile& file) { return file.is_linear(j); });
  };
  std::vector<Told> all;
  std::vector<std::size_t> jumped;
  bool from_zero = false;
  for (std::size_t j = 0; j < identify::kMostJoints; ++j) {
    const Told& told = all.emplace_back(told_of(files, j));
    if (!told.jumps || is_linear(j)) continue;
    const bool is_from_zero = told.lie_from(0);
    if (!is_from_zero && !told.lie_from(-kTurn_rad / 2)) continue;
    const auto end_rad = end_of_circle(told.angles_rad);
    if (!end_rad) continue;
    turn(files, j, *end_rad, told.angles_rad);
    from_zero = from_zero || is_from_zero;
    jumped.push_back(j);
  }
  if (!from_zero) return jumped;
  for (std::size_t j = 0; j < all.size(); ++j) {
    const Told& told = all[j];
    if (told.angles_rad.empty() || told.jumps || is_linear(j)) continue;
    if (told.lie_from(0)) turn(files, j, told.angles_rad.back(), told.angles_rad);
  }
  return jumped;
}

}  // namespace sweepd
