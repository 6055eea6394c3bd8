#include "identify/clock/motion_spans.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/segmentation.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// Above the first it is motion, until it falls below half of it.
constexpr double kStarts_rad_s = 0.2 * kDegree;
constexpr double kStarts_mm_s = MotionLimit::kUsualSlowest_mm_s;
constexpr double kNoiseSigmas = 6;
/// What hides so many times faster motion than usual is worth telling.
constexpr double kNoisy = 2;
/// Less is a twitch.
constexpr double kShortest_s = 2.5 * kMotionWindow_s;

/// `speed(first, centre, last)`: over the samples from first to last.
template <typename Speed>
void find_motion(const std::vector<double>& time_s, double starts, const Speed& speed,
                 Motion& motion) {
  std::vector<double> speeds(time_s.size());
  for (std::size_t begin = 0; begin < time_s.size();) {
    std::size_t end = begin + 1;
    while (end < time_s.size() && time_s[end] - time_s[end - 1] <= kLongestGap_s) ++end;
    motion.seen.push_back({time_s[begin], time_s[end - 1]});
    std::size_t first = begin, last = begin;
    for (std::size_t i = begin; i < end; ++i) {
      while (time_s[first] < time_s[i] - kMotionWindow_s) ++first;
      while (last + 1 < end && time_s[last + 1] <= time_s[i] + kMotionWindow_s) ++last;
      speeds[i] = last > first ? speed(first, i, last) : 0;
    }
    // Both ends of a motion lie where it falls below half of what makes it one.
    std::size_t rest = begin;
    for (std::size_t i = begin; i < end;) {
      if (speeds[i] <= starts) {
        ++i;
        continue;
      }
      std::size_t from = i;
      while (from > rest && speeds[from - 1] > starts / 2) --from;
      while (i < end && speeds[i] > starts / 2) ++i;
      if (from > rest) motion.rests.push_back({time_s[rest], time_s[from - 1]});
      const Span move{time_s[from], time_s[i - 1]};
      if (from > begin && i < end && move.seconds() >= kShortest_s) motion.moves.push_back(move);
      rest = i;
    }
    if (rest < end) motion.rests.push_back({time_s[rest], time_s[end - 1]});
    begin = end;
  }
}

double median_of_3(double a, double b, double c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

/// Of one coordinate: by the smallest steps from one position to the next, those of rests.
double noise_of(const std::vector<Vector3d>& positions) {
  constexpr double kShare = 0.05;
  constexpr double kOfStep = 1 / (0.6 * 1.4142);  // that share of steps is below
  std::vector<double> steps;
  for (std::size_t i = 1; i < positions.size(); ++i)
    steps.push_back((positions[i] - positions[i - 1]).norm());
  if (steps.empty()) return 0;
  const auto at =
      steps.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(steps.size()));
  std::nth_element(steps.begin(), at, steps.end());
  return kOfStep * *at;
}

void add_motion(const TargetTrack& track, double step_mm, Motion& motion) {
  const auto& time_s = track.time_s;
  std::vector<Vector3d> sums(time_s.size() + 1, Vector3d::Zero());
  std::vector<double> times(time_s.size() + 1, 0);
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    Vector3d middle = track.position_mm[i];
    if (i > 0 && i + 1 < time_s.size())
      for (Eigen::Index k = 0; k < 3; ++k)
        middle(k) =
            median_of_3(track.position_mm[i - 1](k), middle(k), track.position_mm[i + 1](k));
    sums[i + 1] = sums[i] + (middle - track.position_mm.front());
    times[i + 1] = times[i] + (time_s[i] - time_s.front());
  }
  // The mean of the later half of a window against that of the earlier half.
  const auto speed = [&](std::size_t first, std::size_t centre, std::size_t last) {
    const std::size_t cut = std::clamp(centre, first + 1, last);
    const auto before = static_cast<double>(cut - first);
    const auto after = static_cast<double>(last + 1 - cut);
    const Vector3d off = (sums[last + 1] - sums[cut]) / after - (sums[cut] - sums[first]) / before;
    const double apart =
        (times[last + 1] - times[cut]) / after - (times[cut] - times[first]) / before;
    return apart > 0 ? off.norm() / apart : 0.0;
  };
  const double rate =
      static_cast<double>(time_s.size()) / std::max(1e-3, time_s.back() - time_s.front());
  const double each = std::max(1.0, rate * kMotionWindow_s);
  const double starts =
      std::max({kStarts_mm_s,
                kNoiseSigmas * noise_of(track.position_mm) * std::sqrt(2 / each) / kMotionWindow_s,
                2 * step_mm / kMotionWindow_s});
  find_motion(time_s, starts, speed, motion);
  if (starts > kNoisy * kStarts_mm_s)
    motion.hidden_below_mm_s = std::max(motion.hidden_below_mm_s, starts);
}

}  // namespace

bool alike(const Span& device, const Span& controller, double least_s, double most_s) {
  // And of all about alike, as they speed up alike.
  constexpr double kApart_s = 0.06, kApart = 0.03;
  const double less = controller.seconds() - device.seconds();
  const double apart = kApart_s + kApart * std::max(device.seconds(), controller.seconds());
  return less > least_s - apart && less < most_s + apart;
}

bool is_within(const std::vector<Span>& seen, const Span& span) {
  return std::any_of(seen.begin(), seen.end(), [&](const Span& looked) {
    return looked.begin_s <= span.begin_s - kSameMove_s && span.end_s + kSameMove_s <= looked.end_s;
  });
}

Motion motion_of(const AngleTape& tape, double step_rad) {
  const auto& time_s = tape.time_s();
  const auto speed = [&](std::size_t first, std::size_t, std::size_t last) {
    double most = 0;
    for (std::size_t j = 0; j < tape.joints(); ++j)
      most = std::max(most, std::abs(tape.angles_rad(last)[j] - tape.angles_rad(first)[j]));
    return most / (time_s[last] - time_s[first]);
  };
  Motion motion;
  find_motion(time_s, std::max(kStarts_rad_s, 1.5 * step_rad / kMotionWindow_s), speed, motion);
  return motion;
}

std::vector<TargetTrack> tracks_of(const std::vector<Measured>& points) {
  std::vector<TargetTrack> tracks;
  for (const Measured& point : points) {
    if (!point.sample.has_position) continue;
    if (tracks.size() <= point.target) tracks.resize(point.target + 1);
    TargetTrack& track = tracks[point.target];
    if (!track.time_s.empty() && !(point.sample.time_s > track.time_s.back())) continue;
    track.time_s.push_back(point.sample.time_s);
    track.position_mm.push_back(point.sample.position_mm);
  }
  return tracks;
}

Motion motion_of(const std::vector<Measured>& points, double step_mm) {
  Motion motion;
  for (const TargetTrack& track : tracks_of(points))
    if (track.time_s.size() > 1) add_motion(track, step_mm, motion);
  return motion;
}

}  // namespace identify
