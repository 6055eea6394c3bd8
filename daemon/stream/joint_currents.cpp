#include "daemon/stream/joint_currents.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

/// Speeds are those of two spans of this length, before and after a moment.
constexpr double kSpan_s = 0.05;
constexpr double kSlowest_deg_s = 0.5;
/// Steady: the two speeds differ by so little. The other joints stand: theirs are so small.
constexpr double kSteadyShare = 0.02;
constexpr double kLongestPause_s = 0.3;

}  // namespace

JointCurrents::Joint::Friction JointCurrents::Joint::friction() const {
  Friction found;
  double sum = 0, squares = 0;
  for (const auto& [degree, place] : places) {
    if (!place.both()) continue;
    ++found.places;
    sum += place.friction();
    squares += place.friction() * place.friction();
  }
  if (found.places == 0) return found;
  const auto count = static_cast<double>(found.places);
  found.mean = std::abs(sum / count);
  if (found.places > 1)
    found.scatter = std::sqrt(std::max(0.0, squares - sum * sum / count) / (count - 1));
  return found;
}

void JointCurrents::take(const identify::Sample& sample, const Currents& currents) {
  if (sample.joints == 0) return;
  if (!recent_.empty() && !(sample.time_s - recent_.back().sample.time_s < kLongestPause_s &&
                            sample.time_s > recent_.back().sample.time_s)) {
    recent_.clear();
    middle_ = 0;
  }
  recent_.push_back({sample, currents});
  const auto is_at = [&](std::size_t index, double spans) {
    return recent_[index].sample.time_s <= sample.time_s - spans * kSpan_s + 1e-9;
  };
  while (middle_ + 1 < recent_.size() && is_at(middle_ + 1, 1)) ++middle_;
  if (!is_at(0, 2)) return;
  while (is_at(1, 2)) {
    recent_.drop();
    --middle_;
  }
  look(recent_.front(), recent_[middle_], recent_.back());
}

void JointCurrents::look(const Moment& before, const Moment& middle, const Moment& now) {
  const auto per_second = [](const Moment& from, const Moment& to) {
    return degrees(1) / (to.sample.time_s - from.sample.time_s);
  };
  const auto turn = [](const Moment& from, const Moment& to, std::size_t j) {
    return to.sample.angles_rad[j] - from.sample.angles_rad[j];
  };
  const std::size_t joints = now.sample.joints;
  std::size_t moving = 0;
  for (std::size_t j = 1; j < joints; ++j)
    if (std::abs(turn(before, now, j)) > std::abs(turn(before, now, moving))) moving = j;
  const double far = std::abs(turn(before, now, moving));
  const double fast = turn(before, now, moving) * per_second(before, now);
  if (moving >= kMostCurrents || !(std::abs(fast) > kSlowest_deg_s)) return;
  for (std::size_t j = 0; j < joints; ++j)
    if (j != moving && std::abs(turn(before, now, j)) > kSteadyShare * far) return;
  if (std::abs(turn(before, middle, moving) * per_second(before, middle) -
               turn(middle, now, moving) * per_second(middle, now)) > kSteadyShare * std::abs(fast))
    return;
  const double current = middle.currents[moving];
  if (!std::isfinite(current)) return;
  if (joints_.size() <= moving) joints_.resize(moving + 1);
  Joint& joint = joints_[moving];
  Place& place =
      joint.places[static_cast<int>(std::floor(degrees(middle.sample.angles_rad[moving])))];
  (fast > 0 ? place.rising : place.falling).add(current);
  joint.speed_deg_s.add(std::abs(fast));
}

}  // namespace sweepd
