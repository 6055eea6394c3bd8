#include "daemon/point_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "daemon/csv_file.hpp"
#include "daemon/units.hpp"
#include "identify/circle_fit.hpp"
#include "identify/points.hpp"
#include "identify/segmentation.hpp"

namespace sweepd {
namespace {

using identify::Sample;
using identify::Sweep;
using identify::SweepDefect;

/// Points chosen by hand: fewer are a circle, but nothing beside it tells that they are one.
constexpr std::size_t kFewestPoints = 4;
/// As in a stream: a locked joint may move by so much.
const double kStill_rad = radians(0.03);

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
  sweep.direction = turned > 0 ? 1 : turned < 0 ? -1 : 0;
  sweep.range_rad = range_of(samples, *sweep.joint);
  const double still = std::max(kStill_rad, 2.5 * resolution.angle_rad);
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

}  // namespace

std::vector<Sweep> streamed_sweeps(const PointsFile& file, std::size_t joints,
                                   const identify::Resolution& resolution) {
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
  return sweeps;
}

std::vector<Sweep> listed_sweeps(const PointsFile& file, const identify::Resolution& resolution) {
  std::vector<Sweep> sweeps;
  for (PointGroup& group : grouped(file)) {
    const std::size_t joint = group.joint - 1;
    if (auto sweep = sweep_of(std::move(group), joint, resolution))
      sweeps.push_back(std::move(*sweep));
  }
  return sweeps;
}

std::vector<Sweep> sweeps_of_joint(const PointsFile& file, std::size_t joint, std::size_t joints,
                                   const identify::Resolution& resolution) {
  std::vector<Sweep> sweeps;
  if (!file.with_times) {
    for (PointGroup& group : grouped(file))
      if (auto sweep = sweep_of(std::move(group), joint, resolution))
        sweeps.push_back(std::move(*sweep));
    return sweeps;
  }
  sweeps = streamed_sweeps(file, joints, resolution);
  for (Sweep& sweep : sweeps)
    if (!sweep.joint) sweep.joint = joint;
  if (!sweeps.empty() && std::none_of(sweeps.begin(), sweeps.end(),
                                      [&](const Sweep& sweep) { return sweep.joint == joint; }))
    throw CsvError(file.path.string() + ": expected sweeps of joint " + std::to_string(joint + 1) +
                   ", as it is number " + std::to_string(joint + 1) +
                   " of the files, found angles of joint " +
                   std::to_string(*sweeps.front().joint + 1) +
                   " alone: give one file a joint, in the order of the joints");
  return sweeps;
}

void declare_directions(std::vector<Sweep>& sweeps, const SweepPlan& plan,
                        const std::vector<identify::DeclaredJoint>& order) {
  std::map<std::size_t, std::vector<Sweep*>> joints;
  for (Sweep& sweep : sweeps)
    if (sweep.joint && sweep.direction == 0) joints[*sweep.joint].push_back(&sweep);
  for (const auto& [joint, strokes] : joints) {
    const auto is_its = [joint = joint](const PlannedSweep& sweep) {
      return sweep.joint == joint + 1;
    };
    const auto planned = std::find_if(plan.sweeps.begin(), plan.sweeps.end(), is_its);
    if (planned == plan.sweeps.end()) continue;
    const auto of_first_target =
        std::count_if(strokes.begin(), strokes.end(), [&strokes = strokes](const Sweep* stroke) {
          return stroke->target == strokes.front()->target;
        });
    int first = planned->end_deg > planned->start_deg ? 1 : -1;
    if (of_first_target > std::count_if(plan.sweeps.begin(), plan.sweeps.end(), is_its))
      for (const auto& declared : order)
        if (declared.joint == joint) {
          first = declared.first_direction;
          break;
        }
    std::optional<Eigen::Vector3d> normal;
    for (Sweep* stroke : strokes) {
      const auto circle = identify::fit_circle(identify::positions(*stroke->samples));
      if (!circle) continue;
      if (!normal) normal = circle->normal;
      stroke->direction = circle->normal.dot(*normal) > 0 ? first : -first;
    }
  }
}

}  // namespace sweepd
