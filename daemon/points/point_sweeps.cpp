#include "daemon/points/point_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <spdlog/fmt/fmt.h>

#include "daemon/points/csv_file.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/sweeps/moved.hpp"
#include "identify/sweeps/position_segmentation.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/segmentation.hpp"
#include "identify/sweeps/sweep.hpp"

namespace sweepd {
namespace {

using identify::Sample;
using identify::Sweep;
using identify::SweepDefect;

/// Points of one target that belong together.
struct PointGroup {
  std::size_t joint = 0;  // from 1; 0: unknown
  std::size_t sweep = 0;
  std::size_t target = 0;
  std::vector<Sample> samples;
};

/// Consecutive points of each target with the same joint and sweep.
std::vector<PointGroup> grouped(const PointsFile& file) {
  std::vector<PointGroup> groups;
  std::map<std::size_t, std::size_t> open;  // by target
  for (const Point& point : file.points) {
    const auto last = open.find(point.target);
    if (last == open.end() || groups[last->second].joint != point.joint ||
        groups[last->second].sweep != point.sweep) {
      open[point.target] = groups.size();
      groups.push_back({point.joint, point.sweep, point.target, {}});
    }
    groups[open[point.target]].samples.push_back(point.sample);
  }
  return groups;
}

/// One group a stroke, where a sweep goes there and back.
std::vector<PointGroup> one_way(PointGroup group) {
  std::erase_if(group.samples, [](const Sample& sample) { return !sample.has_position; });
  std::vector<PointGroup> strokes;
  std::size_t begin = 0;
  auto ends = identify::turning_points(group.samples);
  ends.push_back(group.samples.size());
  for (const std::size_t end : ends) {
    const auto at = [&](std::size_t i) {
      return group.samples.begin() + static_cast<std::ptrdiff_t>(i);
    };
    strokes.push_back({group.joint, group.sweep, group.target, {at(begin), at(end)}});
    begin = end;
  }
  return strokes;
}

double range_of(const std::vector<Sample>& samples, std::size_t joint) {
  const auto [least, most] = std::minmax_element(
      samples.begin(), samples.end(),
      [&](const Sample& a, const Sample& b) { return a.angles_rad[joint] < b.angles_rad[joint]; });
  return most->angles_rad[joint] - least->angles_rad[joint];
}

void judge_by_angles(Sweep& sweep, const identify::Resolution& resolution) {
  const auto& samples = *sweep.samples;
  const double turned =
      sweep.last().angles_rad[*sweep.joint] - sweep.first().angles_rad[*sweep.joint];
  sweep.range_rad = range_of(samples, *sweep.joint);
  // Points in no order have no direction.
  if (std::abs(turned) > sweep.range_rad / 2) sweep.direction = turned > 0 ? 1 : -1;
  const double still = still_angle_rad(resolution.angle_rad);
  for (std::size_t j = 0; j < sweep.first().joints; ++j)
    if (j != *sweep.joint && range_of(samples, j) > still)
      sweep.defect = SweepDefect::other_joint_moved;
}

/// Nothing where no point of the group can be used.
std::optional<Sweep> sweep_of(PointGroup group, std::size_t joint,
                              const identify::Resolution& resolution) {
  auto& samples = group.samples;
  std::erase_if(samples, [](const Sample& sample) { return !sample.has_position; });
  const auto with_angles = [&](const Sample& sample) { return sample.joints > joint; };
  const bool angles = std::any_of(samples.begin(), samples.end(), with_angles);
  if (angles) std::erase_if(samples, [&](const Sample& sample) { return !with_angles(sample); });
  if (samples.empty()) return std::nullopt;

  Sweep sweep;
  sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  sweep.joint = joint;
  sweep.target = group.target;
  const auto circle = identify::fit_circle(identify::positions(*sweep.samples));
  if (circle) sweep.range_rad = circle->arc_rad;
  if (angles) judge_by_angles(sweep, resolution);
  if (sweep.samples->size() < kFewestPoints)
    sweep.defect = SweepDefect::too_few_samples;
  else if (!circle)
    sweep.defect = SweepDefect::not_an_arc;
  else if (sweep.range_rad < identify::kShortestRange_rad)
    sweep.defect = SweepDefect::too_short;
  return sweep;
}

double moved_mm(const PointsFile& file) {
  Eigen::AlignedBox3d box;
  for (const Point& point : file.points)
    if (point.sample.has_position) box.extend(point.sample.position_mm);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

/// Of what moved.
bool none_is_usable(const PointsFile& file, const std::vector<Sweep>& sweeps) {
  return moved_mm(file) > 0 && std::none_of(sweeps.begin(), sweeps.end(), [](const Sweep& sweep) {
           return sweep.defect == SweepDefect::none;
         });
}

// Of a file without a usable sweep. Each throws CsvError where the cause is a column in another
// unit than its name says, or one that says nothing.

void check_times(const PointsFile& file) {
  std::vector<double> times_s;
  std::set<std::size_t> targets;
  for (const Point& point : file.points) {
    times_s.push_back(point.sample.time_s);
    targets.insert(point.target);
  }
  std::sort(times_s.begin(), times_s.end());
  times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
  if (times_s.size() == 1 && file.points.size() > targets.size())
    throw CsvError(
        fmt::format("{}: expected times that rise, as sweeps are found by the motion, found {} s "
                    "for all {} points: give the times, or leave the column out if each file or "
                    "column joint tells whose the points are",
                    file.path.string(), times_s.front(), file.points.size()));
  std::vector<double> steps_s;
  for (std::size_t k = 1; k < times_s.size(); ++k) steps_s.push_back(times_s[k] - times_s[k - 1]);
  const double step_s = steps_s.empty() ? 0 : identify::median_of(steps_s);
  if (step_s > identify::kLongestGap_s)
    throw CsvError(fmt::format(
        "{}: expected times at most {} s apart, as sweeps are found by the motion, found {:.4g} s: "
        "give seconds in t_s if these are milliseconds, or leave the column out if each file or "
        "column joint tells whose the points are",
        file.path.string(), identify::kLongestGap_s, step_s));
}

void check_positions(const PointsFile& file, double noise_mm) {
  const double moved = moved_mm(file);
  if (moved < identify::kSmallestMove_mm && moved > identify::kMovedSizes * noise_mm)
    throw CsvError(
        fmt::format("{}: expected positions that move by {} mm or more, found {:.4g} mm in all: "
                    "name the columns x_m, y_m, z_m, if these are metres",
                    file.path.string(), identify::kSmallestMove_mm, moved));
}

void check_angles(const PointsFile& file) {
  constexpr double kMost_rad = 20;  // three turns: axes without an end make more, but not to sweep
  double most_rad = 0;
  for (const Point& point : file.points)
    for (std::size_t j = 0; j < point.sample.joints; ++j)
      if (!file.is_linear(j)) most_rad = std::max(most_rad, std::abs(point.sample.angles_rad[j]));
  if (most_rad > kMost_rad)
    throw CsvError(
        fmt::format("{}: expected joint angles of up to {} rad, found {:.4g} rad: name the columns "
                    "a1_deg, a2_deg and so on, if these are degrees, and a linear joint's a3_mm",
                    file.path.string(), kMost_rad, most_rad));
}

/// Without angles the targets of one body are taken together: what was seen at one time is a frame.
std::vector<Sweep> sweeps_of_body(const PointsFile& file, const identify::Resolution& resolution,
                                  WorstLimit& limit) {
  std::vector<const Point*> points;
  for (const Point& point : file.points) points.push_back(&point);
  std::stable_sort(points.begin(), points.end(), [](const Point* a, const Point* b) {
    return a->sample.time_s < b->sample.time_s;
  });
  identify::PositionSegmenter segmenter;
  segmenter.set_step(resolution.position_mm);
  std::vector<Sweep> sweeps;
  const auto take = [&](std::vector<Sweep> ended) {
    std::move(ended.begin(), ended.end(), std::back_inserter(sweeps));
  };
  for (std::size_t begin = 0; begin < points.size();) {
    std::vector<identify::PositionSegmenter::Seen> frame;
    const double time = points[begin]->sample.time_s;
    for (; begin < points.size() && points[begin]->sample.time_s == time; ++begin)
      frame.push_back({points[begin]->target, points[begin]->sample});
    take(segmenter.push(frame));
  }
  take(segmenter.finish());
  const auto own = segmenter.limit();
  if (none_is_usable(file, sweeps)) {
    check_times(file);
    if (own) check_positions(file, own->noise_mm);
  }
  if (own && (!limit || limit->noise_mm < own->noise_mm)) limit = own;
  return sweeps;
}

/// Of points without times: of this joint, or of the one that each group names.
std::vector<Sweep> sweeps_of_groups(const PointsFile& file, const identify::Resolution& resolution,
                                    std::optional<std::size_t> joint) {
  std::vector<Sweep> sweeps;
  for (PointGroup& group : grouped(file))
    for (PointGroup& stroke : one_way(std::move(group))) {
      const std::size_t moves = joint.value_or(stroke.joint - 1);
      if (auto sweep = sweep_of(std::move(stroke), moves, resolution))
        sweeps.push_back(std::move(*sweep));
    }
  if (none_is_usable(file, sweeps)) check_angles(file);
  return sweeps;
}

}  // namespace

double still_angle_rad(double step_rad) {
  return std::max(radians(0.03), 2.5 * step_rad);
}

std::vector<Sweep> streamed_sweeps(const PointsFile& file, std::size_t joints,
                                   const identify::Resolution& resolution, WorstLimit& limit) {
  if (file.angles == 0) return sweeps_of_body(file, resolution, limit);
  std::map<std::size_t, identify::Segmenter> streams;  // by target
  std::vector<Sweep> sweeps;
  const auto take = [&](std::size_t target, std::vector<Sweep> ended) {
    for (Sweep& sweep : ended) {
      sweep.target = target;
      sweeps.push_back(std::move(sweep));
    }
  };
  for (const Point& point : file.points) {
    auto& stream = streams.try_emplace(point.target, joints).first->second;
    stream.set_resolution(resolution);
    take(point.target, stream.push(point.sample));
  }
  for (auto& [target, stream] : streams) take(target, stream.finish());
  std::stable_sort(sweeps.begin(), sweeps.end(), [](const Sweep& a, const Sweep& b) {
    return a.first().time_s < b.first().time_s;
  });
  if (none_is_usable(file, sweeps)) {
    check_times(file);
    check_angles(file);
  }
  return sweeps;
}

std::vector<Sweep> listed_sweeps(const PointsFile& file, const identify::Resolution& resolution) {
  return sweeps_of_groups(file, resolution, std::nullopt);
}

std::vector<Sweep> sweeps_of_joint(const PointsFile& file, std::size_t joint, std::size_t joints,
                                   const identify::Resolution& resolution, WorstLimit& limit) {
  if (!file.with_times) return sweeps_of_groups(file, resolution, joint);
  std::vector<Sweep> sweeps = streamed_sweeps(file, joints, resolution, limit);
  for (Sweep& sweep : sweeps)
    if (!sweep.joint) sweep.joint = joint;
  if (!sweeps.empty() && std::none_of(sweeps.begin(), sweeps.end(),
                                      [&](const Sweep& sweep) { return sweep.joint == joint; }))
    throw CsvError(fmt::format(
        "{}: expected sweeps of joint {}, as it is number {} of the files, found angles of joint "
        "{} alone: give one file a joint, in the order of the joints",
        file.path.string(), joint + 1, joint + 1, *sweeps.front().joint + 1));
  return sweeps;
}

}  // namespace sweepd
