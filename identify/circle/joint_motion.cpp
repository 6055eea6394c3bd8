#include "identify/circle/joint_motion.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "identify/geometry/median.hpp"
#include "identify/geometry/warning.hpp"

namespace identify {
namespace {

/// Motion so many times as fast as the slowest that noise does not hide is seen from end to end.
constexpr double kClearlySeen = 2;

}  // namespace

std::optional<JointMotion> joint_motion(const JointResult& joint) {
  std::vector<double> speeds;
  std::vector<double> steps;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
    if (!joint.used[s]) continue;
    const auto& samples = *joint.sweeps[s].samples;
    const std::size_t span = std::max<std::size_t>(1, samples.size() / 10);
    for (std::size_t i = samples.size() / 4 + span; i < samples.size() - samples.size() / 4; ++i) {
      const Sample& before = samples[i - span];
      const double time = samples[i].time_s - before.time_s;
      if (!samples[i].has_position || !before.has_position || !(time > 0)) continue;
      const double way = (samples[i].position_mm - before.position_mm).norm();
      speeds.push_back(way / time);
      steps.push_back(way / static_cast<double>(span));
    }
  }
  if (steps.empty()) return std::nullopt;
  return JointMotion{median_of(std::move(speeds)), median_of(std::move(steps))};
}

std::optional<Warning> hidden_motion(const CircleEstimate& found, const MotionLimit& limit) {
  if (!limit.by_noise()) return std::nullopt;
  const double clearly_mm_s = kClearlySeen * limit.slowest_mm_s;
  std::string hidden;
  double slowest_mm_s = clearly_mm_s;
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const auto moved = joint_motion(found.joints[j]);
    if (moved && found.joints[j].axis && moved->speed_mm_s >= clearly_mm_s) continue;
    hidden += (hidden.empty() ? "" : ", ") + std::to_string(j + 1);
    if (moved) slowest_mm_s = std::min(slowest_mm_s, moved->speed_mm_s);
  }
  if (hidden.empty()) return std::nullopt;
  std::string message = "a position noise of " + brief(limit.noise_mm) +
                        " mm hides motion slower than " + brief(limit.slowest_mm_s) +
                        " mm/s and arcs shorter than " + brief(limit.shortest_mm) +
                        " mm: perhaps sweeps of joint " + hidden + ", or parts of them";
  if (slowest_mm_s < clearly_mm_s)
    message += ", where the target was seen to move at " + brief(slowest_mm_s) + " mm/s";
  message += "; sweep so fast that the target moves at " + brief(clearly_mm_s) +
             " mm/s or more, rest for half a second between moves, measure more target points at "
             "once, or let the device average more";
  return Warning{"motion_limit", std::nullopt, std::move(message)};
}

}  // namespace identify
