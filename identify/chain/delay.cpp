#include "identify/chain/delay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "identify/chain/angle_track.hpp"
#include "identify/chain/delay_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/sweeps/reference_motion.hpp"

namespace identify {
namespace {

/// Less certain than this, a delay is of no use.
constexpr double kWorstSigma_s = 0.05;
/// So many samples tell how an angle goes on where it was not told.
constexpr std::size_t kAtEnd = 50;

/// The axis that a sweep ran about, wherever the other joints stood; along positive rotation, as
/// the joint's angle tells.
std::optional<ChainAxis> own_axis(const Sweep& sweep, std::size_t joint, bool linear) {
  const auto points = positions(*sweep.samples);
  ReferenceMotion motion;
  motion.linear = linear;
  if (points.cols() == 0 || !set_reference(motion, points, points.col(0))) return std::nullopt;
  const CircleFit& circle = motion.circle;
  ChainAxis axis{linear ? circle.normal.cross(motion.arm) : circle.normal, circle.center_mm,
                 linear};
  AngleAbout about(axis);
  double along = 0;
  const Sample* before = nullptr;
  double seen = 0;
  for (const Sample& sample : *sweep.samples) {
    if (!sample.has_position || sample.joints <= joint) continue;
    const double now = about.next(sample.position_mm);
    if (before != nullptr)
      along += (now - seen) * (sample.angles_rad[joint] - before->angles_rad[joint]);
    before = &sample;
    seen = now;
  }
  if (along < 0) axis.direction = -axis.direction;
  return axis;
}

}  // namespace

double untold_delay_s(const Delay& delay) {
  if (is_significant(delay)) return delay.sigma_s;
  // A controller's telegrams have angles and positions of one moment, most likely; else of a cycle
  // or a few apart.
  constexpr double kAnyDelay = 0.05, kUsual_s = 0.01;
  const double variance = delay.sigma_s * delay.sigma_s;
  const double share = kUsual_s * kUsual_s / (variance + kUsual_s * kUsual_s);
  const double factor =
      std::sqrt(1 - share) * std::exp(share * delay.late_s * delay.late_s / variance / 2);
  const double likely = kAnyDelay * factor / (1 - kAnyDelay + kAnyDelay * factor);
  return std::sqrt(likely * (share * share * delay.late_s * delay.late_s + share * variance));
}

double play_by_delay_rad(const JointResult& joint, const Delay& delay, double noise_mm,
                         double stamp_step_s) {
  double speed = 0, untold = 0, sigma_s = delay.sigma_s;
  std::array<double, 2> strokes{}, stamps_s2{};  // by the way
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
    const Sweep& sweep = joint.sweeps[s];
    const double seconds = sweep.last().time_s - sweep.first().time_s;
    if (!joint.used[s] || !(seconds > 0)) continue;
    speed = std::max(speed, sweep.range_rad / seconds);
    untold = std::max(untold, std::min(1.0, std::abs(delay.late_s) / seconds));
    if (delay.rate != 0)
      sigma_s = std::max(
          sigma_s,
          std::hypot(delay.sigma_s, delay.rate_sigma * (sweep.first().time_s - delay.at_s)));
    const std::size_t way = sweep.direction > 0 ? 1 : 0;
    ++strokes[way];
    stamps_s2[way] += std::pow(stamps_off_s(*sweep.samples, stamp_step_s), 2);
  }
  double by_stamps_s2 = 0;
  for (std::size_t way = 0; way < 2; ++way)
    if (strokes[way] > 0) by_stamps_s2 += stamps_s2[way] / (strokes[way] * strokes[way]);
  const double reach_mm = joint.circle ? joint.circle->radius_mm : kLinear_mm;
  return std::hypot(2 * speed * sigma_s, speed * std::sqrt(by_stamps_s2),
                    untold * noise_mm / reach_mm);
}

std::optional<Delay> find_delay(const CircleEstimate& circles,
                                const std::vector<std::optional<ChainAxis>>& axes,
                                const Campaign& campaign) {
  const auto tracks = angle_tracks(circles, axes, campaign);
  if (tracks.empty()) return std::nullopt;
  auto delay = fitted_delay(tracks, campaign.two_clocks);
  if (delay && !(delay->sigma_s < kWorstSigma_s)) return std::nullopt;
  return delay;
}

bool is_significant(const Delay& delay) noexcept {
  return std::abs(delay.late_s) > kSignificantDelay * delay.sigma_s || delay.rate != 0;
}

CircleEstimate in_step(CircleEstimate circles, const std::vector<std::optional<ChainAxis>>& axes,
                       const Delay& delay) {
  for (std::size_t j = 0; j < circles.joints.size(); ++j) {
    if (!axes[j]) continue;
    JointResult& joint = circles.joints[j];
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      Sweep& sweep = joint.sweeps[s];
      sweep.repeats.reset();  // in sums no angle can be put off
      const auto axis =
          joint.used[s] || sweep.positioning ? axes[j] : own_axis(sweep, j, axes[j]->linear);
      if (!axis) continue;
      const auto track = angle_track(sweep, j, *axis);
      if (!track) continue;
      auto samples = *sweep.samples;
      AngleAbout about(*axis);
      std::vector<double> seen(samples.size());
      std::vector<bool> told(samples.size(), false);
      std::vector<double> off;  // told minus seen, where both are
      for (std::size_t i = 0; i < samples.size(); ++i) {
        Sample& sample = samples[i];
        if (sample.has_position) seen[i] = about.next(sample.position_mm);
        const double late = delay.late_s + delay.rate * (sample.time_s - delay.at_s);
        const auto then = track->told(sample.time_s + late);
        told[i] = then.has_value();
        if (!then) continue;
        sample.angles_rad[j] = then->angle_rad;
        if (sample.has_position) off.push_back(then->angle_rad - seen[i]);
      }
      if (off.empty()) continue;
      const auto near = static_cast<std::ptrdiff_t>(std::min<std::size_t>(kAtEnd, off.size()));
      const double before = median_of({off.begin(), off.begin() + near});
      const double after = median_of({off.end() - near, off.end()});
      bool begun = false;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        begun = begun || told[i];
        if (!told[i] && samples[i].has_position)
          samples[i].angles_rad[j] = seen[i] + (begun ? after : before);
      }
      sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
    }
  }
  return circles;
}

}  // namespace identify
