#include "identify/sweeps/position_segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
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
constexpr double kFirstSize_mm = 1e-6;
constexpr double kSizesPerOctave = 8;
/// Motion leaves more than noise does: of all windows the quieter ones tell the noise.
constexpr double kQuiet = 0.25;
/// So many frames of a window at most tell its slope: of more, every second, third, …
constexpr std::size_t kMostFrames = 1000;

double moves_above(double sigma, double step) {
  return std::max({kStarts_mm_s, 2.0 * step / (2 * kHalfWindow_s), kStartSigmas * sigma});
}
double rests_below(double sigma, double step) {
  return std::max({kStops_mm_s, 1.2 * step / (2 * kHalfWindow_s), kStopSigmas * sigma});
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
  // The last frame may be a stray: only the next one tells.
  while (window_.size() > 1 &&
         window_[undecided_].time_s + kHalfWindow_s <= window_[window_.size() - 2].time_s) {
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
  close();
  window_.clear();
  undecided_ = 0;
  moves_ = false;
  velocity_.clear();
  return std::exchange(ended_, {});
}

void PositionSegmenter::look_for_strays() {
  const double noise = noise_mm();
  if (window_.size() < 3 || noise == 0) return;
  const Frame& before = window_[window_.size() - 3];
  const Frame& after = window_.back();
  const auto of = [](const Frame& frame, std::size_t target) {
    return std::find_if(frame.seen.begin(), frame.seen.end(),
                        [&](const Kept& seen) { return seen.target == target; });
  };
  for (Kept& seen : window_[window_.size() - 2].seen) {
    const auto one = of(before, seen.target), other = of(after, seen.target);
    if (one == before.seen.end() || other == after.seen.end()) continue;
    // Beside the box of the two in time.
    const auto& a = one->sample.position_mm;
    const auto& b = other->sample.position_mm;
    const Vector3d beside = seen.sample.position_mm -
                            seen.sample.position_mm.cwiseMax(a.cwiseMin(b)).cwiseMin(a.cwiseMax(b));
    seen.stray = beside.norm() > std::max(kStray_mm, kStraySizes * noise);
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
    if (fit.count < 6) continue;
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
  if (!moves || along < 0 || stroke_.size() >= most_samples_) close();
  moves_ = moves;
  velocity_ = slope.velocity_mm_s;
  if (moves) stroke_.push_back(window_[centre]);
}

void PositionSegmenter::close() {
  std::map<std::size_t, std::vector<Kept>> targets;
  for (const Frame& frame : std::exchange(stroke_, {}))
    for (const Kept& seen : frame.seen)
      if (auto& of_target = targets[seen.target]; !seen.stray || !of_target.empty())
        of_target.push_back(seen);
  for (auto& [target, seen] : targets) {
    while (!seen.empty() && seen.back().stray) seen.pop_back();
    if (seen.size() > 1) report(target, seen);
  }
}

void PositionSegmenter::report(std::size_t target, const std::vector<Kept>& seen) {
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

namespace {

constexpr double kSway_rad = 2 * kDegree;
constexpr double kFewestInStroke = 4;

/// Turned about the circle, unwrapped. A point that is beside it stands where the one before it
/// did.
std::vector<double> turns_about(const CircleFit& circle, const Eigen::Matrix3Xd& points) {
  constexpr double kBeside = 10;  // root mean squares
  constexpr double kRounding = 1e-6;
  const double most_mm = std::max(kBeside * std::hypot(circle.plane_rms_mm, circle.radial_rms_mm),
                                  kRounding * circle.radius_mm);
  const Eigen::Vector3d across = circle.normal.unitOrthogonal();
  const Eigen::Vector3d up = circle.normal.cross(across);
  std::vector<double> turns;
  std::optional<double> last;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d from = points.col(i) - circle.center_mm;
    const CircleResidual off = residual(circle, points.col(i));
    if (std::hypot(off.plane_mm, off.radial_mm) <= most_mm) {
      const double angle = std::atan2(up.dot(from), across.dot(from));
      last = last ? *last + std::remainder(angle - *last, 2 * kPi) : angle;
    }
    if (last) turns.push_back(*last);
  }
  if (last)
    turns.insert(turns.begin(), static_cast<std::size_t>(points.cols()) - turns.size(),
                 turns.front());
  return turns;
}

/// Of each number, and of up to two before and behind it: a stray one is passed over.
std::vector<double> running_medians(const std::vector<double>& numbers) {
  constexpr std::size_t kBeside = 2;
  std::vector<double> medians;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t beside = std::min({kBeside, i, numbers.size() - 1 - i});
    const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(i - beside);
    medians.push_back(median_of({begin, begin + static_cast<std::ptrdiff_t>(2 * beside + 1)}));
  }
  return medians;
}

}  // namespace

std::vector<std::size_t> turning_points(const std::vector<Sample>& samples) {
  const auto points = positions(samples);
  if (static_cast<std::size_t>(points.cols()) != samples.size()) return {};
  const auto circle = fit_robust_circle(points);
  if (!circle) return {};
  const double noise = circle->radial_rms_mm / circle->radius_mm;
  const double sway = std::max(kSway_rad, 6 * noise);
  const auto turns = running_medians(turns_about(*circle, points));
  std::vector<std::size_t> found;
  // The farthest point of the stroke under way; the stroke has ended once the motion came back from
  // it by more than a sway.
  std::size_t farthest = 0, nearest = 0;
  int way = 0;
  for (std::size_t i = 1; i < turns.size(); ++i) {
    if (way >= 0 && turns[i] > turns[farthest]) farthest = i;
    if (way <= 0 && turns[i] < turns[nearest]) nearest = i;
    if (way == 0) {
      if (turns[i] - turns[nearest] > sway) way = 1;
      if (turns[farthest] - turns[i] > sway) way = -1;
    } else if (way > 0 && turns[farthest] - turns[i] > sway) {
      found.push_back(farthest);
      nearest = i;
      way = -1;
    } else if (way < 0 && turns[i] - turns[nearest] > sway) {
      found.push_back(nearest);
      farthest = i;
      way = 1;
    }
  }
  const auto strokes = static_cast<double>(found.size() + 1);
  if (static_cast<double>(samples.size()) < kFewestInStroke * strokes) found.clear();
  return found;
}

}  // namespace identify
