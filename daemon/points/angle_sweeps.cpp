#include "daemon/points/angle_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "daemon/points/point_sweeps.hpp"
#include "identify/sweeps/segmentation.hpp"

namespace sweepd {
namespace {

/// Lines of one target, from the first on, in which one joint alone has moved.
struct Run {
  std::optional<std::size_t> joint;
  std::vector<std::size_t> points;
  double least_rad = 0;  // of that joint
  double most_rad = 0;

  [[nodiscard]] bool is_sweep() const {
    return joint && points.size() >= kFewestPoints &&
           most_rad - least_rad >= identify::kShortestRange_rad;
  }
};

/// False if the point is of another run.
bool takes(Run& run, const std::vector<Point>& points, std::size_t at, double still_rad) {
  const auto& now = points[at].sample;
  const auto& first = points[run.points.front()].sample;
  if (now.joints != first.joints) return false;
  auto moved = run.joint;
  for (std::size_t j = 0; j < now.joints; ++j) {
    if (j == run.joint || std::abs(now.angles_rad[j] - first.angles_rad[j]) <= still_rad) continue;
    if (moved) return false;
    moved = j;
  }
  if (moved && !run.joint) run.least_rad = run.most_rad = first.angles_rad[*moved];
  run.joint = moved;
  run.points.push_back(at);
  if (!moved) return true;
  run.least_rad = std::min(run.least_rad, now.angles_rad[*moved]);
  run.most_rad = std::max(run.most_rad, now.angles_rad[*moved]);
  return true;
}

std::vector<Run> runs_in(const std::vector<Point>& points, double still_rad) {
  std::vector<Run> runs;
  std::map<std::size_t, Run> open;  // by target
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].sample.joints == 0 || !points[i].sample.has_position) continue;
    Run& run = open[points[i].target];
    if (!run.points.empty() && takes(run, points, i, still_rad)) continue;
    runs.push_back(std::exchange(run, {{}, {i}}));
  }
  for (auto& [target, run] : open) runs.push_back(std::move(run));
  return runs;
}

}  // namespace

bool find_sweeps_by_angles(PointsFile& file, double angle_step_rad) {
  const auto runs = runs_in(file.points, still_angle_rad(angle_step_rad));
  std::size_t in_sweeps = 0;
  for (const Run& run : runs)
    if (run.is_sweep()) in_sweeps += run.points.size();
  if (in_sweeps <= file.points.size() / 2) return false;
  std::size_t sweeps = 0;
  for (const Run& run : runs) {
    if (!run.is_sweep()) continue;
    ++sweeps;
    for (const std::size_t i : run.points) {
      file.points[i].joint = *run.joint + 1;
      file.points[i].sweep = sweeps;
    }
  }
  std::erase_if(file.points, [](const Point& point) { return point.joint == 0; });
  file.with_joints = true;
  return true;
}

}  // namespace sweepd
