#include "identify/chain/angle_track.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/sweeps/even_motion.hpp"
#include "identify/sweeps/home.hpp"
#include "identify/sweeps/stroke_rounding.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kFewestSeen = 20;

/// So many samples tell an angle between two of them.
constexpr std::size_t kAround = 4;
/// An interval of so many usual ones is a gap.
constexpr double kGap = 3.5;

/// The cubic through the samples from this one on (Lagrange).
double between(const AngleTrack& track, double at, std::size_t from) {
  double sum = 0;
  for (std::size_t a = from; a < from + kAround; ++a) {
    double weight = 1;
    for (std::size_t b = from; b < from + kAround; ++b)
      if (b != a) weight *= (at - track.time_s[b]) / (track.time_s[a] - track.time_s[b]);
    sum += weight * track.told_rad[a];
  }
  return sum;
}

Eigen::Map<const Eigen::ArrayXd> as_array(const std::vector<double>& numbers) {
  return {numbers.data(), static_cast<Eigen::Index>(numbers.size())};
}

/// A speed is that between so many samples before and behind.
std::size_t wide_of(const AngleTrack& track) {
  return std::max<std::size_t>(5, track.time_s.size() / 30);
}

/// The step that times seem to be rounded to: an even clock's intervals then differ by one.
double step_of(const std::vector<double>& intervals, double usual) {
  double least = usual, most = usual;
  for (const double interval : intervals) {
    if (std::abs(interval - usual) > usual / 2) continue;  // something is missing
    least = std::min(least, interval);
    most = std::max(most, interval);
  }
  return most - least;
}

/// Of the times: where pieces without a gap begin, and by what speeds are off.
void judge_times(AngleTrack& track, double step_rad) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < track.time_s.size(); ++i)
    intervals.push_back(track.time_s[i] - track.time_s[i - 1]);
  const double usual = median_of(intervals);
  track.begins = {0};
  for (std::size_t i = 0; i < intervals.size(); ++i)
    if (intervals[i] > kGap * usual) track.begins.push_back(i + 1);

  const double speed = (track.told_rad.back() - track.told_rad.front()) /
                       (track.time_s.back() - track.time_s.front());
  Eigen::ArrayXd uneven(static_cast<Eigen::Index>(track.time_s.size()));
  for (std::size_t i = 0; i < track.time_s.size(); ++i)
    uneven(static_cast<Eigen::Index>(i)) = track.told_rad[i] - speed * track.time_s[i];
  // Where numbers go on by nearly whole steps they are even, but for a step now and then: the
  // variance of that is at most a quarter of its square. Times do so, too.
  const double step = std::max(step_rad, std::abs(speed) * step_of(intervals, usual));
  const double variance = std::max(step * step / 4, 2 * unevenness(uneven));
  track.speed_noise_rad_s = std::sqrt(variance) / (2 * static_cast<double>(wide_of(track)) * usual);
}

/// Speeds of the positions, if they tell them in half of the time.
void see_speeds(AngleTrack& track) {
  const std::size_t count = track.at_s.size();
  const double interval = (track.at_s.back() - track.at_s.front()) / static_cast<double>(count - 1);
  const double speed =
      (track.seen_rad.back() - track.seen_rad.front()) / (track.at_s.back() - track.at_s.front());
  const double scatter =
      std::sqrt(2 * unevenness(as_array(track.seen_rad) - speed * as_array(track.at_s)));
  const double wide = std::ceil(scatter / (2 * interval * track.speed_noise_rad_s));
  const auto told_wide =
      static_cast<double>(wide_of(track) * count) / static_cast<double>(track.time_s.size());
  constexpr double kLeastWide = 2;
  if (!(2 * std::max(wide, kLeastWide) < told_wide)) return;
  const auto beside = static_cast<std::size_t>(std::max(wide, kLeastWide));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i > beside ? i - beside : 0;
    const std::size_t to = std::min(count - 1, i + beside);
    track.seen_speed_rad_s.push_back((track.seen_rad[to] - track.seen_rad[from]) /
                                     (track.at_s[to] - track.at_s[from]));
  }
}

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
  const auto after = std::upper_bound(time_s.begin(), time_s.end(), at);
  if (after == time_s.begin() || after == time_s.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - time_s.begin());
  const std::size_t nearest = at - time_s[i - 1] < time_s[i] - at ? i - 1 : i;
  const auto next = std::upper_bound(begins.begin(), begins.end(), nearest);
  // The motion may have turned round beside the first and the last one.
  const std::size_t begin = *std::prev(next) + 1;
  const std::size_t end = (next == begins.end() ? time_s.size() : *next) - 1;
  if (nearest < begin || nearest >= end || end < begin + kAround) return std::nullopt;
  const std::size_t wide = wide_of(*this);
  const std::size_t from = nearest > begin + wide ? nearest - wide : begin;
  const std::size_t to = std::min(end - 1, nearest + wide);
  return Told{between(*this, at, std::min(i > begin + 2 ? i - 2 : begin, end - kAround)),
              (told_rad[to] - told_rad[from]) / (time_s[to] - time_s[from])};
}

std::optional<AngleTrack> angle_track(const Sweep& sweep, std::size_t joint, const ChainAxis& axis,
                                      double step_rad, std::size_t most) {
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
  track.linear = axis.linear;
  track.reach_mm = axis.linear ? kLinear_mm : radius;
  std::vector<double> distances;
  for (std::size_t i = 0; i < radii.size(); ++i)
    distances.push_back(std::hypot(heights[i] - height, radii[i] - radius));
  const double usual = median_of(distances);
  const std::size_t every = (radii.size() + most - 1) / most;
  AngleAbout about(axis);
  std::vector<double> told_rad;  // beside those seen
  std::size_t good = 0;
  for (const Sample& sample : *sweep.samples) {
    if (!sample.has_position) continue;
    const auto [at, off] = frame.place(sample.position_mm);
    if (std::hypot(at - height, off - radius) > kOutlierDistances * usual || ++good % every != 0)
      continue;
    track.at_s.push_back(sample.time_s);
    track.seen_rad.push_back(about.next(sample.position_mm));
    told_rad.push_back(sample.angles_rad[joint]);
  }
  if (std::min(track.at_s.size(), track.time_s.size()) < kFewestSeen) return std::nullopt;
  judge_times(track, step_rad);
  see_speeds(track);
  constexpr double kOfMedian = 1.18;  // of distances in a plane, in standard deviations
  track.printed_rad =
      told_level_rad(as_array(track.at_s), as_array(told_rad), as_array(track.seen_rad),
                     usual / kOfMedian / track.reach_mm, step_rad);
  return track;
}

double stamps_off_s(const std::vector<Sample>& samples, double step_s) {
  if (!(step_s > 0)) return 0;
  std::vector<double> intervals;
  const Sample* before = nullptr;
  for (const Sample& sample : samples) {
    if (!sample.has_position) continue;
    if (before != nullptr) intervals.push_back(sample.time_s - before->time_s);
    before = &sample;
  }
  if (intervals.empty()) return kEvenlySpread * step_s;
  const double usual = median_of(intervals);
  const auto others = std::count_if(intervals.begin(), intervals.end(), [&](double interval) {
    return std::abs(std::remainder(interval, usual)) > step_s / 2;
  });
  return kEvenlySpread * step_s / (1 + static_cast<double>(others));
}

std::vector<AngleTrack> angle_tracks(const CircleEstimate& circles,
                                     const std::vector<std::optional<ChainAxis>>& axes,
                                     const Campaign& campaign) {
  std::map<std::size_t, std::vector<AngleTrack>> groups;
  for (std::size_t j = 0; j < circles.joints.size(); ++j) {
    const JointResult& joint = circles.joints[j];
    if (!axes[j]) continue;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      const Sweep& sweep = joint.sweeps[s];
      const bool on_the_way =
          campaign.two_clocks && sweep.positioning && at_home(sweep, circles.home_rad, {});
      if ((!joint.used[s] && !on_the_way) || sweep.direction == 0) continue;
      auto track = angle_track(sweep, j, *axes[j], campaign.resolution.angle_rad,
                               campaign.two_clocks ? sweep.samples->size() : kMostTracked);
      if (!track) continue;
      track->off_home_rad = off_home_rad(sweep, circles.home_rad);
      track->stamps_s = stamps_off_s(*sweep.samples, campaign.resolution.time_s);
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
