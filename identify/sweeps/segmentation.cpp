#include "identify/sweeps/segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

/// A locked joint may sag or wobble by so much.
constexpr double kStill_rad = 0.03 * kDegree;
/// Speeds above the first are motion, until they fall below the second.
constexpr double kJointStarts_rad_s = 0.2 * kDegree;
constexpr double kJointStops_rad_s = 0.1 * kDegree;

}  // namespace

Segmenter::Segmenter(std::size_t joints, std::size_t most_samples)
    : joints_(std::min(joints, kMostJoints)),
      most_samples_(most_samples),
      by_positions_(most_samples) {}

std::vector<Sweep> Segmenter::push(const Sample& sample) {
  if (!with_angles_.value_or(false)) {
    with_angles_ = sample.joints > 0;
    if (*with_angles_) by_positions_ = PositionSegmenter(most_samples_);
  }
  if (!*with_angles_) return by_positions_.push({{0, sample}});
  if (sample.joints < joints_) return {};
  if (!window_.empty() && sample.time_s <= window_.back().time_s) return {};

  if (!window_.empty() && sample.time_s - window_.back().time_s > kLongestGap_s) ended_ = finish();
  window_.push_back(sample);
  while (window_[undecided_].time_s + kHalfWindow_s <= window_.back().time_s) {
    decide(window_[undecided_]);
    ++undecided_;
    while (window_.front().time_s < window_[undecided_ - 1].time_s - kHalfWindow_s) {
      window_.drop();
      --undecided_;
    }
  }
  return std::exchange(ended_, {});
}

std::vector<Sweep> Segmenter::finish() {
  if (with_angles_ && !*with_angles_) return by_positions_.finish();
  for (; undecided_ < window_.size(); ++undecided_) decide(window_[undecided_]);
  close();
  window_.clear();
  undecided_ = 0;
  joint_moves_.fill(false);
  return std::exchange(ended_, {});
}

void Segmenter::decide(const Sample& centre) {
  const auto first = std::find_if(window_.begin(), window_.end(), [&](const Sample& s) {
    return s.time_s >= centre.time_s - kHalfWindow_s;
  });
  auto last = std::prev(window_.end());
  while (last->time_s > centre.time_s + kHalfWindow_s) --last;
  Motion motion;
  if (last->time_s > first->time_s) motion = joint_motion(*first, *last);

  if (motion != motion_ || stroke_.size() >= most_samples_) {
    close();
    motion_ = motion;
  }
  if (motion_.joint != kNothing) stroke_.push_back(centre);
}

Segmenter::Motion Segmenter::joint_motion(const Sample& first, const Sample& last) {
  const double seconds = last.time_s - first.time_s;
  const double starting = std::max(kJointStarts_rad_s, kStartSteps_1_s * resolution_.angle_rad);
  const double stopping = std::max(kJointStops_rad_s, kStopSteps_1_s * resolution_.angle_rad);
  Motion motion;
  int moving = 0;
  for (std::size_t j = 0; j < joints_; ++j) {
    const double speed = (last.angles_rad[j] - first.angles_rad[j]) / seconds;
    joint_moves_[j] = std::abs(speed) > (joint_moves_[j] ? stopping : starting);
    if (!joint_moves_[j]) continue;
    ++moving;
    motion = {static_cast<int>(j), speed > 0 ? 1 : -1};
  }
  return moving == 1 ? motion : Motion{};
}

void Segmenter::close() {
  if (motion_.joint != kNothing && stroke_.size() > 1) {
    Sweep sweep;
    sweep.samples = trimmed();
    sweep.joint = static_cast<std::size_t>(motion_.joint);
    sweep.direction = motion_.sign;
    judge_by_angles(sweep);
    if (sweep.range_rad >= kShortestStroke_rad) ended_.push_back(std::move(sweep));
  }
  stroke_.clear();
  motion_ = {};
}

std::shared_ptr<const std::vector<Sample>> Segmenter::trimmed() const {
  const Sample& first = stroke_.front();
  const Sample& last = stroke_.back();
  const double rest = std::max(kRest * travel(first, last), 1.5 * resolution_.angle_rad);
  auto begin = stroke_.begin();
  auto end = stroke_.end();
  while (end - begin > 2 && travel(first, *(begin + 1)) <= rest) ++begin;
  while (end - begin > 2 && travel(last, *(end - 2)) <= rest) --end;
  return std::make_shared<const std::vector<Sample>>(begin, end);
}

double Segmenter::travel(const Sample& from, const Sample& to) const {
  const auto j = static_cast<std::size_t>(motion_.joint);
  return std::abs(to.angles_rad[j] - from.angles_rad[j]);
}

void Segmenter::judge_by_angles(Sweep& sweep) const {
  auto lowest = sweep.first().angles_rad;
  auto highest = lowest;
  for (const Sample& sample : *sweep.samples)
    for (std::size_t j = 0; j < joints_; ++j) {
      lowest[j] = std::min(lowest[j], sample.angles_rad[j]);
      highest[j] = std::max(highest[j], sample.angles_rad[j]);
    }
  sweep.range_rad = highest[*sweep.joint] - lowest[*sweep.joint];
  const double still = std::max(kStill_rad, 2.5 * resolution_.angle_rad);
  for (std::size_t j = 0; j < joints_; ++j)
    if (j != *sweep.joint && highest[j] - lowest[j] > still)
      sweep.defect = SweepDefect::other_joint_moved;
  if (sweep.samples->size() < kFewestSamples) sweep.defect = SweepDefect::too_few_samples;
  if (sweep.range_rad < kShortestRange_rad) sweep.defect = SweepDefect::too_short;
}

}  // namespace identify
