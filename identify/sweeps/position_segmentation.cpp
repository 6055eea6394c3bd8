#include "identify/sweeps/position_segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/segmentation.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// Speeds above the first are motion, until they fall below the second.
constexpr double kStarts_mm_s = MotionLimit::kUsualSlowest_mm_s;
constexpr double kStops_mm_s = 1.0;
/// So many standard deviations of what noise makes of rest are motion; of rest again.
constexpr double kStartSigmas = 6;
constexpr double kStopSigmas = 3;
/// The ringing after a stop runs through any angle, but hardly leaves its place.
constexpr double kShortest_mm = MotionLimit::kUsualShortest_mm;
constexpr double kShortestSizes = 30;  // of the noise
/// Strays lie so far beside the positions before and behind them; in sizes of the noise.
constexpr double kStray_mm = 1;
constexpr double kStraySizes = 10;
/// And, where they are so for more than a frame, so many times farther than they move meanwhile; as
/// markers are that a camera takes for each other.
constexpr double kStraySteps = 3;
constexpr double kLongestAside_s = 0.1;
constexpr std::size_t kMostAside = 50;  // frames, of those that come ever so fast
constexpr double kFirstSize_mm = 1e-6;
constexpr double kSizesPerOctave = 8;
/// Motion leaves more than noise does: of all windows the quieter ones tell the noise.
constexpr double kQuiet = 0.25;
/// So many frames of a window at most tell its slope: of more, every second, third, …
constexpr std::size_t kMostFrames = 1000;

double moves_above(double sigma, double step) {
  return std::max({kStarts_mm_s, kStartSteps_1_s * step, kStartSigmas * sigma});
}
double rests_below(double sigma, double step) {
  return std::max({kStops_mm_s, kStopSteps_1_s * step, kStopSigmas * sigma});
}

double shortest(double noise) {
  return std::max(kShortest_mm, kShortestSizes * noise);
}

}  // namespace

std::vector<Sweep> PositionSegmenter::push(const std::vector<Seen>& frame) {
  Frame next;
  for (const Seen& seen : frame)
    if (seen.sample.has_position && seen.sample.position_mm.allFinite())
      next.seen.push_back({seen});
  if (next.seen.empty()) return {};
  next.time_s = next.seen.front().sample.time_s;
  if (!window_.empty() && next.time_s <= window_.back().time_s) return {};
  if (!window_.empty() && next.time_s - window_.back().time_s > kLongestGap_s) ended_ = finish();
  window_.push_back(std::move(next));
  look_for_strays();
  // The last frames may be strays: only those behind them tell.
  while (window_.size() > 1 && window_[undecided_].time_s + kHalfWindow_s <=
                                   std::min(window_[window_.size() - 2].time_s,
                                            window_.back().time_s - kLongestAside_s)) {
    decide(undecided_);
    ++undecided_;
    while (window_.front().time_s < window_[undecided_ - 1].time_s - kHalfWindow_s) {
      window_.pop_front();
      --undecided_;
    }
  }
  return std::exchange(ended_, {});
}

std::vector<Sweep> PositionSegmenter::finish() {
  for (; undecided_ < window_.size(); ++undecided_) decide(undecided_);
  close(!moves_);
  window_.clear();
  undecided_ = 0;
  moves_ = false;
  blind_before_ = true;
  velocity_.clear();
  return std::exchange(ended_, {});
}

void PositionSegmenter::look_for_strays() {
  const double noise = noise_mm();
  if (noise == 0) return;
  const double least = std::max(kStray_mm, kStraySizes * noise);
  for (Kept& after : window_.back().seen) {
    // Where the target was, the last one first.
    std::vector<Kept*> track{&after};
    for (auto frame = window_.rbegin() + 1; frame != window_.rend(); ++frame) {
      const auto here = std::find_if(frame->seen.begin(), frame->seen.end(),
                                     [&](const Kept& seen) { return seen.target == after.target; });
      if (here == frame->seen.end()) continue;
      track.push_back(&*here);
      if (track.size() > 3 && window_.back().time_s - frame->time_s > kLongestAside_s) break;
      if (track.size() == kMostAside) break;
    }
    const auto step = [&](std::size_t k) {
      return (track[k]->sample.position_mm - track[k + 1]->sample.position_mm).norm();
    };
    // It may have been elsewhere since `before`: it came and went in one frame each, and moved
    // little ahead and in between.
    double between = 0;
    for (std::size_t before = 2; before < track.size(); ++before) {
      double most = least;
      if (before > 2) {
        between = std::max(between, step(before - 2));
        const double ahead = before + 1 < track.size() ? step(before) : 0;
        most = std::max(least, kStraySteps * std::max(between, ahead));
      }
      const auto& from = track[before]->sample.position_mm;
      const auto& to = after.sample.position_mm;
      const auto beside = [&](const Kept* seen) {
        // Of the box of the two.
        const auto& at = seen->sample.position_mm;
        return (at - at.cwiseMax(from.cwiseMin(to)).cwiseMin(from.cwiseMax(to))).norm() > most;
      };
      const auto begin = track.begin() + 1,
                 end = track.begin() + static_cast<std::ptrdiff_t>(before);
      if (!std::all_of(begin, end, beside)) continue;
      for (auto seen = begin; seen != end; ++seen) (*seen)->stray = true;
    }
  }
}

PositionSegmenter::Slope PositionSegmenter::slope_at(std::size_t centre) const {
  // A margin for times that are rounded.
  constexpr double kMargin_s = 1e-9;
  const double at = window_[centre].time_s;
  struct Fit {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();  // of 1, t, t^2
    Eigen::Matrix3d right = Eigen::Matrix3d::Zero();   // columns: x, y, z
    double squares = 0;
    int count = 0;
    Vector3d origin_mm = Vector3d::Zero();
  };
  std::map<std::size_t, Fit> fits;
  const std::size_t stride = 1 + window_.size() / kMostFrames;
  for (std::size_t i = 0; i < window_.size(); i += stride) {
    const Frame& frame = window_[i];
    const double t = frame.time_s - at;
    if (std::abs(t) > kHalfWindow_s + kMargin_s) continue;
    const Vector3d powers(1, t / kHalfWindow_s, t * t / (kHalfWindow_s * kHalfWindow_s));
    for (const Kept& seen : frame.seen) {
      if (seen.stray) continue;
      Fit& fit = fits[seen.target];
      if (fit.count++ == 0) fit.origin_mm = seen.sample.position_mm;
      const Vector3d off = seen.sample.position_mm - fit.origin_mm;
      fit.normal += powers * powers.transpose();
      fit.right += powers * off.transpose();
      fit.squares += off.squaredNorm();
    }
  }
  Slope slope;
  double speeds = 0, left = 0, variances = 0;
  int freedom = 0, used = 0;
  for (const auto& [target, fit] : fits) {
    if (fit.count < 2) continue;
    // The mean speed is a straight line's; the parabola tells what is noise.
    const Eigen::Matrix2d straight = fit.normal.topLeftCorner<2, 2>();
    if (!(straight.determinant() > 1e-12)) continue;
    const Eigen::Matrix2d inverse = straight.inverse();
    const Vector3d velocity = (inverse.row(1) * fit.right.topRows<2>()).transpose() / kHalfWindow_s;
    slope.velocity_mm_s[target] = velocity;
    speeds += velocity.squaredNorm();
    variances += 3 * inverse(1, 1) / (kHalfWindow_s * kHalfWindow_s);
    ++used;
    if (fit.count < 5) continue;
    const Eigen::Matrix3d found = fit.normal.ldlt().solve(fit.right);
    left += std::max(0.0, fit.squares - found.cwiseProduct(fit.right).sum());
    freedom += 3 * (fit.count - 3);
  }
  if (used > 0) {
    slope.speed_mm_s = std::sqrt(speeds / used);
    // The mean square of several targets' speeds scatters less, by the root of their number.
    slope.sigma_mm_s = std::sqrt(variances / used / std::sqrt(used));
  }
  if (freedom > 0) slope.noise_mm = std::sqrt(left / freedom);
  return slope;
}

void PositionSegmenter::learn(const Slope& slope) {
  const double size = std::log2(std::max(slope.noise_mm, kFirstSize_mm) / kFirstSize_mm);
  const auto bin = static_cast<std::size_t>(kSizesPerOctave * size);
  ++sizes_[std::min(bin, sizes_.size() - 1)];
  ++learnt_;
}

std::optional<MotionLimit> PositionSegmenter::limit() const {
  const double noise = noise_mm();
  if (noise == 0) return std::nullopt;
  return MotionLimit{noise, moves_above(sigma_mm_s_ * noise, step_mm_), shortest(noise)};
}

double PositionSegmenter::noise_mm() const {
  auto quiet = static_cast<std::size_t>(kQuiet * static_cast<double>(learnt_));
  if (learnt_ == 0) return 0;
  std::size_t bin = 0;
  for (; bin + 1 < sizes_.size() && quiet >= sizes_[bin]; ++bin) quiet -= sizes_[bin];
  return kFirstSize_mm * std::exp2((static_cast<double>(bin) + 0.5) / kSizesPerOctave);
}

void PositionSegmenter::decide(std::size_t centre) {
  const Slope slope = slope_at(centre);
  if (slope.noise_mm > 0) learn(slope);
  // At the ends of a stream half a window is seen: that tells less than the others.
  const double time_s = window_[centre].time_s;
  const bool whole = time_s - window_.front().time_s > 0.9 * kHalfWindow_s &&
                     window_.back().time_s - time_s > 0.9 * kHalfWindow_s;
  if (whole || sigma_mm_s_ == 0) sigma_mm_s_ = slope.sigma_mm_s;
  const double sigma = slope.sigma_mm_s * noise_mm();
  const bool moves =
      slope.speed_mm_s > (moves_ ? rests_below(sigma, step_mm_) : moves_above(sigma, step_mm_));
  double along = 0;
  for (const auto& [target, velocity] : slope.velocity_mm_s)
    if (const auto before = velocity_.find(target); before != velocity_.end())
      along += velocity.dot(before->second);
  // A reversal without a rest begins another stroke.
  const bool ends = !moves || along < 0;
  const bool grown = stroke_.size() >= most_samples_;
  if (ends || grown) close(ends);
  if (stroke_.empty()) begin_seen_ = !blind_before_ && (ends || !grown);
  blind_before_ = false;
  moves_ = moves;
  velocity_ = slope.velocity_mm_s;
  if (moves) stroke_.push_back(window_[centre]);
}

void PositionSegmenter::close(bool end_seen) {
  const auto stroke = std::exchange(stroke_, {});
  std::map<std::size_t, std::vector<Kept>> targets;
  for (const Frame& frame : stroke)
    for (const Kept& seen : frame.seen)
      if (auto& of_target = targets[seen.target]; !seen.stray || !of_target.empty())
        of_target.push_back(seen);
  for (auto& [target, seen] : targets) {
    while (!seen.empty() && seen.back().stray) seen.pop_back();
    if (seen.size() < 2) continue;
    // A target may have come into sight later than the others, or gone earlier.
    const double late_s = seen.front().sample.time_s - stroke.front().time_s;
    const double early_s = stroke.back().time_s - seen.back().sample.time_s;
    report(target, seen, begin_seen_ && late_s <= kLongestGap_s,
           end_seen && early_s <= kLongestGap_s);
  }
}

void PositionSegmenter::report(std::size_t target, const std::vector<Kept>& seen, bool begin_seen,
                               bool end_seen) {
  const double noise = noise_mm();
  const auto travel = [](const Kept& from, const Kept& to) {
    return (to.sample.position_mm - from.sample.position_mm).norm();
  };
  const Kept &first = seen.front(), &last = seen.back();
  const double rest = std::max({kRest * travel(first, last), 1.5 * step_mm_, 4 * noise});
  auto begin = seen.begin(), end = seen.end();
  while (end - begin > 2 && travel(first, *(begin + 1)) <= rest) ++begin;
  while (end - begin > 2 && travel(last, *(end - 2)) <= rest) --end;
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(end - begin));
  Eigen::Matrix3Xd points(3, end - begin);
  Eigen::Index count = 0;
  for (auto at = begin; at != end; ++at) {
    samples.push_back(at->sample);
    if (!at->stray) points.col(count++) = at->sample.position_mm;
  }

  Sweep sweep;
  sweep.target = target;
  sweep.begin_seen = begin_seen;
  sweep.end_seen = end_seen;
  sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  const auto circle = fit_circle(points.leftCols(count));
  // A move of two joints leaves the circle by millimetres; measuring noise does not.
  constexpr double kNoise_mm = 0.05;
  constexpr double kNoisePerLength = 2e-4;
  constexpr double kNoiseSigmas = 1.5;
  const auto allowed = [&](const CircleFit& one) {
    return std::max(kNoise_mm, kNoiseSigmas * noise) +
           kNoisePerLength * one.arc_rad * one.radius_mm + step_mm_;
  };
  const auto misfit = [](const CircleFit& one) {
    return std::max(one.plane_rms_mm, one.radial_rms_mm);
  };
  if (!circle) {
    sweep.range_rad = kShortestStroke_rad;
    sweep.defect = SweepDefect::not_an_arc;
  } else {
    sweep.range_rad = circle->arc_rad;
    const double half_turn = std::min(circle->arc_rad, 180 * kDegree);
    const double extent = 2 * circle->radius_mm * std::sin(half_turn / 2);
    if (sweep.samples->size() < kFewestSamples) sweep.defect = SweepDefect::too_few_samples;
    if (sweep.range_rad < kShortestRange_rad || extent < shortest(noise))
      sweep.defect = SweepDefect::too_short;
    if (misfit(*circle) > allowed(*circle)) sweep.defect = SweepDefect::not_an_arc;
  }
  if (sweep.range_rad >= kShortestStroke_rad) ended_.push_back(std::move(sweep));
}

}  // namespace identify
