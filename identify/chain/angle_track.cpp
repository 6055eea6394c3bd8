#include "identify/chain/angle_track.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/sweeps/home.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kFewestSeen = 20;

/// Of the strokes' seen angles each may lack whole turns against the others.
void count_alike(std::vector<AngleTrack>& tracks) {
  const double first_seen = tracks.front().seen_rad.front();
  const double first_told = tracks.front().told_rad.front();
  double least = first_seen, most = first_seen;
  for (AngleTrack& track : tracks) {
    const double apart =
        track.seen_rad.front() - first_seen - (track.told_rad.front() - first_told);
    const double turns = wrapped(apart) - apart;
    for (double& seen : track.seen_rad) seen += turns;
    const auto [low, high] = std::minmax_element(track.seen_rad.begin(), track.seen_rad.end());
    least = std::min(least, *low);
    most = std::max(most, *high);
  }
  for (AngleTrack& track : tracks) {
    track.middle_rad = (least + most) / 2;
    track.half_rad = std::max((most - least) / 2, 1e-9);
  }
}

}  // namespace

std::optional<AngleTrack::Told> AngleTrack::told(double at) const {
  if (!(at >= time_s.front()) || !(at <= time_s.back())) return std::nullopt;
  const auto after = std::upper_bound(time_s.begin() + 1, time_s.end() - 1, at);
  const auto i = static_cast<std::size_t>(after - time_s.begin());
  const std::size_t wide = std::max<std::size_t>(5, time_s.size() / 30);
  const std::size_t from = i > wide ? i - wide : 0;
  const std::size_t to = std::min(time_s.size() - 1, i + wide);
  return Told{between(at, i), (told_rad[to] - told_rad[from]) / (time_s[to] - time_s[from])};
}

/// The cubic through the four samples around (Lagrange); `i` is the first one after `at`.
double AngleTrack::between(double at, std::size_t i) const {
  const std::size_t from = std::min(i > 2 ? i - 2 : 0, time_s.size() - 4);
  double sum = 0;
  for (std::size_t a = from; a < from + 4; ++a) {
    double weight = 1;
    for (std::size_t b = from; b < from + 4; ++b)
      if (b != a) weight *= (at - time_s[b]) / (time_s[a] - time_s[b]);
    sum += weight * told_rad[a];
  }
  return sum;
}

std::optional<AngleTrack> angle_track(const Sweep& sweep, std::size_t joint, const ChainAxis& axis,
                                      std::size_t most) {
  AngleTrack track;
  track.direction = sweep.direction;
  const AngleAbout frame(axis);
  std::vector<double> heights, radii;
  for (const Sample& sample : *sweep.samples) {
    if (sample.joints <= joint) return std::nullopt;
    if (!track.time_s.empty() && !(sample.time_s > track.time_s.back())) continue;
    track.time_s.push_back(sample.time_s);
    track.told_rad.push_back(sample.angles_rad[joint]);
    if (!sample.has_position) continue;
    const auto [height, radius] = frame.place(sample.position_mm);
    heights.push_back(height);
    radii.push_back(radius);
  }
  if (radii.size() < kFewestSeen) return std::nullopt;
  const double height = median_of(heights), radius = median_of(radii);
  std::vector<double> distances;
  for (std::size_t i = 0; i < radii.size(); ++i)
    distances.push_back(std::hypot(heights[i] - height, radii[i] - radius));
  const double usual = median_of(distances);
  const std::size_t every = (radii.size() + most - 1) / most;
  AngleAbout about(axis);
  std::size_t good = 0;
  for (const Sample& sample : *sweep.samples) {
    if (!sample.has_position) continue;
    const auto [at, off] = frame.place(sample.position_mm);
    if (std::hypot(at - height, off - radius) > kOutlierDistances * usual || ++good % every != 0)
      continue;
    track.at_s.push_back(sample.time_s);
    track.seen_rad.push_back(about.next(sample.position_mm));
  }
  if (track.at_s.size() < kFewestSeen) return std::nullopt;
  return track;
}

std::vector<AngleTrack> angle_tracks(const CircleEstimate& circles,
                                     const std::vector<std::optional<ChainAxis>>& axes,
                                     bool two_clocks) {
  std::map<std::size_t, std::vector<AngleTrack>> groups;
  for (std::size_t j = 0; j < circles.joints.size(); ++j) {
    const JointResult& joint = circles.joints[j];
    if (!axes[j]) continue;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      const Sweep& sweep = joint.sweeps[s];
      const bool on_the_way =
          two_clocks && sweep.positioning && at_home(sweep, circles.home_rad, {});
      if ((!joint.used[s] && !on_the_way) || sweep.direction == 0) continue;
      auto track =
          angle_track(sweep, j, *axes[j], two_clocks ? sweep.samples->size() : kMostTracked);
      if (!track) continue;
      track->off_home_rad = off_home_rad(sweep, circles.home_rad);
      groups[sweep.target * circles.joints.size() + j].push_back(std::move(*track));
    }
  }
  std::vector<AngleTrack> tracks;
  std::size_t group = 0;
  for (auto& [key, of_group] : groups) {
    for (AngleTrack& track : of_group) track.group = group;
    count_alike(of_group);
    std::move(of_group.begin(), of_group.end(), std::back_inserter(tracks));
    ++group;
  }
  return tracks;
}

}  // namespace identify
