#include "identify/clock/joined_take.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "identify/clock/clock_rates.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/poses/arm_fit.hpp"
#include "identify/sweeps/moved.hpp"
#include "identify/sweeps/segmentation.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// What is left of a rest of 0.3 s, seen through the window of motion.
constexpr double kShortestRest_s = 0.14;
/// Cut off its ends: what rings, and what the clocks are not known to.
constexpr double kMargin_s = 0.03;
constexpr std::size_t kFewestAtRest = 5;
/// A joint that turned by more has taken up its play.
constexpr double kTurned_rad = 0.01 * kDegree;
/// Positions at rest scatter by more than this many times what is usual: the target moved.
constexpr double kRestless = 5;
constexpr double kRestless_mm = 0.02;
/// By the specified arm, poses of the right clocks are nearer than this, and those of others so
/// many times further off.
constexpr double kPlaced_mm = 20;
constexpr double kFurther = 3;

struct Rest {
  Pose pose;
  double scatter_mm = 0;
};

/// In which senses the joints came to each rest that the angles tell.
std::vector<JointSenses> senses_in(const AngleTape& tape, const std::vector<Span>& rests,
                                   double angle_step_rad) {
  // Less is wobble or the last digit.
  const double turned_rad = std::max(kTurned_rad, 4 * angle_step_rad);
  std::vector<JointSenses> all;
  JointSenses senses{};
  JointAngles farthest{};  // in the sense of its motion
  std::size_t i = 0;
  for (const Span& rest : rests) {
    for (; i < tape.size() && tape.time_s()[i] < rest.begin_s; ++i)
      for (std::size_t j = 0; j < tape.joints(); ++j) {
        const double told = tape.angles_rad(i)[j];
        double& end = farthest[j];
        if (i == 0) end = told;
        if (std::abs(told - end) > turned_rad) senses[j] = told > end ? 1 : -1;
        if (std::abs(told - end) > turned_rad || (told - end) * senses[j] > 0) end = told;
      }
    all.push_back(senses);
  }
  return all;
}

/// One a rest of the angles and target that the device saw.
std::vector<Rest> rests_in(const AngleTape& tape, const Motion& angles,
                           const std::vector<JointSenses>& senses,
                           const std::vector<TargetTrack>& tracks, const ClockMatch& clock) {
  const double margin = kMargin_s + 3 * clock.sigma_s;
  std::vector<Rest> rests;
  for (std::size_t r = 0; r < angles.rests.size(); ++r) {
    const Span& span = angles.rests[r];
    if (span.seconds() < kShortestRest_s) continue;
    const double begin = span.begin_s + margin, end = span.end_s - margin;
    const auto mean = tape.mean(begin, end);
    if (!mean) continue;
    for (std::size_t target = 0; target < tracks.size(); ++target) {
      const auto& times = tracks[target].time_s;
      const auto from = std::lower_bound(
          times.begin(), times.end(), begin,
          [&](double device, double at) { return clock.controller_s(device) < at; });
      std::vector<Vector3d> seen;
      for (auto at = from; at != times.end() && clock.controller_s(*at) <= end; ++at)
        seen.push_back(tracks[target].position_mm[static_cast<std::size_t>(at - times.begin())]);
      if (seen.size() < kFewestAtRest) continue;
      std::vector<Vector3d> copy = seen;
      const Vector3d middle = median(copy);
      std::vector<double> distances;
      distances.reserve(seen.size());
      for (const Vector3d& point : seen) distances.push_back((point - middle).norm());
      Rest rest;
      rest.scatter_mm = median_of(distances);
      // The mean, less what is far off the middle.
      Vector3d sum = Vector3d::Zero();
      double count = 0;
      for (const Vector3d& point : seen)
        if ((point - middle).norm() <= kRestless * rest.scatter_mm + 1e-9) {
          sum += point;
          ++count;
        }
      rest.pose.sample.position_mm = sum / count;
      rest.pose.sample.has_position = true;
      rest.pose.sample.time_s = (begin + end) / 2;
      rest.pose.sample.joints = static_cast<std::uint8_t>(tape.joints());
      rest.pose.sample.angles_rad = *mean;
      rest.pose.target = target;
      rest.pose.senses = senses[r];
      rest.pose.name = "rest at " + fixed(rest.pose.sample.time_s, 1) + " s";
      rests.push_back(rest);
    }
  }
  return rests;
}

/// Those in which the target stood as still as it usually does.
std::vector<Pose> still_poses(const std::vector<Rest>& rests, std::size_t& restless) {
  std::vector<double> scatters;
  scatters.reserve(rests.size());
  for (const Rest& rest : rests) scatters.push_back(rest.scatter_mm);
  const double most = kRestless * median_of(scatters) + kRestless_mm;
  std::vector<Pose> poses;
  restless = 0;
  for (const Rest& rest : rests)
    if (rest.scatter_mm <= most)
      poses.push_back(rest.pose);
    else
      ++restless;
  return poses;
}

/// How far the poses are from where the specified arm has them, wherever it stands: the middle one.
double distance_mm(const std::vector<Pose>& poses, const Campaign& campaign) {
  std::size_t targets = 0;
  for (const Pose& pose : poses) targets = std::max(targets, pose.target + 1);
  return middle_of(
      distances_mm(placed_robustly(*campaign.specified, Freedom::frames, poses, targets), poses));
}

/// The one of several matches that the specified arm can have made; nothing where it does not tell.
std::optional<ClockMatch> by_arm(const std::vector<ClockMatch>& matches, const AngleTape& tape,
                                 const Motion& angles, const std::vector<JointSenses>& senses,
                                 const std::vector<TargetTrack>& tracks, const Campaign& campaign) {
  if (!campaign.specified) return std::nullopt;
  constexpr std::size_t kFewestPoses = 6;
  std::vector<std::pair<double, ClockMatch>> by_distance;
  for (const ClockMatch& match : matches) {
    std::size_t restless = 0;
    const auto poses = still_poses(rests_in(tape, angles, senses, tracks, match), restless);
    if (poses.size() < kFewestPoses) return std::nullopt;
    by_distance.emplace_back(distance_mm(poses, campaign), match);
  }
  std::stable_sort(by_distance.begin(), by_distance.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (by_distance[0].first > kPlaced_mm || by_distance[1].first < kFurther * by_distance[0].first)
    return std::nullopt;
  return by_distance[0].second;
}

std::size_t moved_joints(const AngleTape& tape, const Span& move) {
  constexpr int kLooks = 10;
  JointAngles least{}, most{};
  bool first = true;
  for (int i = 0; i <= kLooks; ++i) {
    const auto told = tape.at(move.begin_s + move.seconds() * i / kLooks);
    if (!told) continue;
    for (std::size_t j = 0; j < tape.joints(); ++j) {
      least[j] = first ? (*told)[j] : std::min(least[j], (*told)[j]);
      most[j] = first ? (*told)[j] : std::max(most[j], (*told)[j]);
    }
    first = false;
  }
  std::size_t moved = 0;
  for (std::size_t j = 0; j < tape.joints(); ++j)
    if (most[j] - least[j] > kShortestStroke_rad) ++moved;
  return moved;
}

bool is_seen(const std::vector<TargetTrack>& tracks, const ClockMatch& clock, const Span& move) {
  return std::any_of(tracks.begin(), tracks.end(), [&](const TargetTrack& track) {
    const auto at = std::lower_bound(
        track.time_s.begin(), track.time_s.end(), move.begin_s,
        [&](double device_s, double begin_s) { return clock.controller_s(device_s) < begin_s; });
    return at != track.time_s.end() && clock.controller_s(*at) <= move.end_s;
  });
}

/// Stamps that are frames of one length, each as printed, are not rounded.
double stamp_step_s(const std::vector<TargetTrack>& tracks) {
  constexpr double kNear = 0.01;
  for (const double step : {0.01, 0.001, 0.0001}) {  // less is no matter
    bool whole = true, frames = true;
    for (const auto& [times, positions] : tracks) {
      std::vector<double> intervals;
      for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
      if (intervals.empty()) continue;
      const double usual = median_of(intervals);
      for (const double time : times) {
        whole = whole && std::abs(std::remainder(time, step)) < kNear * step;
        frames = frames && std::abs(std::remainder(time - times.front(), usual)) < step / 2;
      }
    }
    if (whole) return frames ? 0 : step;
  }
  return 0;
}

/// What is wrong where a target's times go back by more than lines overtake each other.
std::string set_back(const std::vector<Measured>& points) {
  constexpr double kOvertaken_s = 0.5;
  std::map<std::size_t, double> latest_s;  // by target
  for (const Measured& point : points) {
    const double time_s = point.sample.time_s;
    double& latest = latest_s.try_emplace(point.target, time_s).first->second;
    if (time_s < latest - kOvertaken_s)
      return "the device's times go back from " + fixed(latest, 3) + " to " + fixed(time_s, 3) +
             " s: its clock was set, or its program began anew; give each part of the take as a "
             "file of its own";
    latest = std::max(latest, time_s);
  }
  return {};
}

/// What hides all motion, where times or positions are in another unit.
std::string in_another_unit(const std::vector<TargetTrack>& tracks) {
  std::vector<double> steps_s, steps_mm;
  double moved_mm = 0;
  for (const auto& [times, positions] : tracks) {
    for (std::size_t i = 1; i < times.size(); ++i) {
      steps_s.push_back(times[i] - times[i - 1]);
      steps_mm.push_back((positions[i] - positions[i - 1]).norm());
    }
    for (const Vector3d& position : positions)
      moved_mm = std::max(moved_mm, (position - positions.front()).norm());
  }
  if (steps_s.empty()) return {};
  const double step_s = median_of(std::move(steps_s));
  if (step_s > kLongestGap_s)
    return "the device's points are " + brief(step_s) +
           " s apart: give seconds in t_s, if these are milliseconds";
  if (moved_mm < kSmallestMove_mm && moved_mm > kMovedSizes * median_of(std::move(steps_mm)))
    return "the device's points move by " + brief(moved_mm) +
           " mm in all: name the columns x_m, y_m, z_m, if these are metres";
  return {};
}

std::string ambiguity(const std::vector<ClockMatch>& matches, const Campaign& campaign) {
  const std::string apart =
      fixed(matches[0].ahead_s, 3) + " and " + fixed(matches[1].ahead_s, 3) + " s";
  return "the clocks can be matched in " + std::to_string(matches.size()) +
         " ways: the motions fit offsets of " + apart + " about as well; " +
         (campaign.specified
              ? "and the robot description fits none of them, or several: "
              : "give the robot description with --robot, which may tell them apart, or ") +
         "record with a rest of another length between two of the sweeps";
}

}  // namespace

JoinedTake joined(const AngleTape& tape, const std::vector<Measured>& points,
                  const Campaign& campaign) {
  JoinedTake take;
  take.problem = set_back(points);
  if (!take.problem.empty()) return take;
  const Motion angles = motion_of(tape, campaign.resolution.angle_rad);
  const Motion seen = motion_of(points, campaign.resolution.position_mm);
  ClockSearch search = match_clocks(seen, angles);
  if (search.matches.empty())
    if (ClockSearch other = match_wrong_rate(seen, angles); !other.matches.empty())
      search = std::move(other);
  take.problem = search.problem;
  const auto tracks = tracks_of(points);
  if (search.matches.empty()) {
    if (auto unit = in_another_unit(tracks); !unit.empty()) take.problem = std::move(unit);
    return take;
  }
  take.stamp_step_s = stamp_step_s(tracks);
  const auto senses = senses_in(tape, angles.rests, campaign.resolution.angle_rad);
  take.clock = search.matches.front();
  if (search.matches.size() > 1) {
    const auto one = by_arm(search.matches, tape, angles, senses, tracks, campaign);
    if (!one) {
      take.problem = ambiguity(search.matches, campaign);
      return take;
    }
    take.clock = *one;
  }

  take.poses = still_poses(rests_in(tape, angles, senses, tracks, take.clock), take.restless);
  std::map<std::size_t, Segmenter> streams;  // by target
  const auto keep = [&](std::size_t target, std::vector<Sweep> ended) {
    for (Sweep& sweep : ended) {
      sweep.target = target;
      take.sweeps.push_back(std::move(sweep));
    }
  };
  for (const Measured& point : points) {
    Sample sample = point.sample;
    sample.time_s = take.clock.controller_s(sample.time_s);
    const auto told = tape.at(sample.time_s);
    if (!told || !sample.has_position) continue;
    sample.angles_rad = *told;
    sample.joints = static_cast<std::uint8_t>(tape.joints());
    auto& stream = streams.try_emplace(point.target, tape.joints()).first->second;
    stream.set_resolution(campaign.resolution);
    keep(point.target, stream.push(sample));
  }
  for (auto& [target, stream] : streams) keep(target, stream.finish());
  std::stable_sort(take.sweeps.begin(), take.sweeps.end(), [](const Sweep& a, const Sweep& b) {
    return a.first().time_s < b.first().time_s;
  });

  for (const Span& move : angles.moves)
    if (moved_joints(tape, move) > 1 && is_seen(tracks, take.clock, move))
      take.left_out_s += move.seconds();
  for (const Sweep& sweep : take.sweeps) {
    const auto& samples = *sweep.samples;
    if (samples.size() < 2 * kFewestSamples) continue;
    const auto& a = samples[samples.size() / 2 - 5];
    const auto& b = samples[samples.size() / 2 + 5];
    if (b.time_s > a.time_s)
      take.fastest_mm_s = std::max(take.fastest_mm_s,
                                   (b.position_mm - a.position_mm).norm() / (b.time_s - a.time_s));
  }
  if (take.sweeps.empty() && take.poses.empty())
    take.problem =
        "device and controller have neither a sweep of a single joint nor a rest of 0.3 s in "
        "common: record both at the same time";
  return take;
}

ClockMatch refined(const ClockMatch& clock, const std::optional<Delay>& delay) {
  if (!delay || delay->sigma_s > clock.sigma_s) return clock;
  ClockMatch better = clock;
  better.at_s = delay->at_s;
  better.ahead_s = clock.ahead_s + clock.rate * (delay->at_s - clock.at_s) - delay->late_s;
  better.sigma_s = delay->sigma_s;
  if (delay->rate_sigma > 0) {
    better.rate = clock.rate - delay->rate;
    better.rate_sigma = delay->rate_sigma;
  }
  return better;
}

}  // namespace identify
