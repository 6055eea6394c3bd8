#include "identify/told_turn.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "identify/circle/joint_motion.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/plausibility.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// Gears err by minutes of arc. Angles that come late look wrong by what the joint turns meanwhile.
constexpr double kWrongTurn_rad = 5 * kDegree;
constexpr double kWrongTurnShare = 0.3;
constexpr double kLate_s = 0.75;
constexpr double kRadiusSigmas = 5;
/// What was seen, divided by what radians for degrees make of it, is what was told but for this.
constexpr double kAboutRadians = 0.05;
/// Closer to the axis, in distances of the points from the circle, angles about it are noise.
constexpr double kLeastRadius = 20;

/// Against each other, the lower and the upper third of the angles that were told: a delay, or a
/// stroke there and back, shifts both.
std::optional<Warning> wrong_turn(const Identification& found, std::size_t j, double usual_mm) {
  const JointResult& joint = found.joints[j];
  const CircleFit& circle = *found.joints[j].circle;
  if (circle.radius_mm < kLeastRadius * usual_mm) return std::nullopt;
  const Vector3d x = circle.normal.unitOrthogonal();
  const Vector3d y = circle.normal.cross(x);
  const double radius_sigma_mm = CircleCovariance(circle, used_points(joint, joint.circle_target),
                                                  found.samples_per_independent())
                                     .radius_sigma_mm();
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
    if (!joint.used[s] || joint.sweeps[s].target != joint.circle_target) continue;
    struct Turn {
      double told;
      double error;
    };
    std::vector<Turn> turns;
    for (const Sample& sample : *joint.sweeps[s].samples) {
      if (!sample.has_position || sample.joints <= j) continue;
      const Vector3d arm = sample.position_mm - circle.center_mm;
      turns.push_back(
          {sample.angles_rad[j], sample.angles_rad[j] - std::atan2(arm.dot(y), arm.dot(x))});
    }
    const std::size_t third = turns.size() / 3;
    if (third < 2) continue;
    std::sort(turns.begin(), turns.end(),
              [](const Turn& a, const Turn& b) { return a.told < b.told; });
    const double start = turns[third / 2].error;
    const auto middle = [&](std::size_t from, double Turn::*of) {
      std::vector<double> values;
      for (std::size_t i = from; i < from + third; ++i)
        values.push_back(of == &Turn::error ? wrapped(turns[i].error - start) : turns[i].told);
      return median_of(std::move(values));
    };
    const std::size_t upper = turns.size() - third;
    const double told = middle(upper, &Turn::told) - middle(0, &Turn::told);
    const double off = middle(upper, &Turn::error) - middle(0, &Turn::error);
    const Sweep& sweep = joint.sweeps[s];
    const double seconds = sweep.last().time_s - sweep.first().time_s;
    const double late =
        seconds > 0 ? kLate_s / seconds * (turns.back().told - turns.front().told) : 0;
    // In a short arc noise hides the radius, and with it how far the target was seen to turn.
    const double unsure = kRadiusSigmas * radius_sigma_mm / circle.radius_mm * told;
    if (!(std::abs(off) > kWrongTurn_rad + late + unsure) ||
        !(std::abs(off) > kWrongTurnShare * told))
      continue;
    const bool radians = std::abs((told - off) * kDegree - told) < kAboutRadians * told;
    return Warning{"angle_arc_mismatch", j,
                   joint_name(j) + ": while its angle turned by " + fixed(told / kDegree, 1) +
                       "°, the target was seen to turn by " + fixed((told - off) / kDegree, 1) +
                       "°: " +
                       (radians ? "the angles look like radians: give them in degrees"
                                : "the angles are not this joint's, or not of these positions")};
  }
  return std::nullopt;
}

/// How far a joint turns while its angles may be on their way, where that was not found.
double untold_rad(const Identification& found, const JointResult& joint) {
  double most = 0;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
    const Sweep& sweep = joint.sweeps[s];
    const double seconds = sweep.last().time_s - sweep.first().time_s;
    if (joint.used[s] && seconds > 0 && !found.delay)
      most = std::max(most, kLate_s / seconds * sweep.range_rad);
  }
  return most;
}

/// On another way there than back, or along a curve, beyond what any gear does.
std::optional<Warning> unlike_gears(const Identification& found, std::size_t j) {
  if (!found.chain || found.chain->angles[j].samples == 0) return std::nullopt;
  const AngleEvidence& seen = found.chain->angles[j];
  const double radius_mm = found.joints[j].circle->radius_mm;
  const double late_rad = untold_rad(found, found.joints[j]);
  const auto beyond = [&](double off_rad, double sigma_rad, double by_delay_rad) {
    return off_rad > kApart_rad + kApartSigmas * sigma_rad + by_delay_rad &&
           off_rad * radius_mm > kApart_mm;
  };
  const auto doubt = [&](double off_rad, const std::string& how) {
    return Warning{"angle_arc_mismatch", j,
                   joint_name(j) + ": its angles are off " + how + " by " +
                       fixed(off_rad / kDegree, 1) + "°, " + brief(off_rad * radius_mm) +
                       " mm at the target, and no gear is: another joint moved along, or the "
                       "angles are not of these positions"};
  };
  const double play_rad = std::abs(seen.backlash_rad);
  if (seen.backlash_sigma_rad > 0 && beyond(play_rad, seen.backlash_sigma_rad, 2 * late_rad))
    return doubt(play_rad, "one way against the other");
  if (seen.trust != AngleTrust::smooth) return std::nullopt;
  const auto curve = curve_swing(found, j);
  if (!curve || !beyond(curve->swing_rad, seen.center_sigma_rad, late_rad)) return std::nullopt;
  return doubt(curve->swing_rad, "along a curve");
}

}  // namespace

std::optional<CurveSwing> curve_swing(const Identification& found, std::size_t joint) {
  const JointResult& swept = found.joints[joint];
  const auto home = found.home_rad[joint];
  if (!home || !found.chain) return std::nullopt;
  double lowest = 0, highest = 0, from = 0, to = 0;
  bool any = false;
  for (std::size_t s = 0; s < swept.sweeps.size(); ++s) {
    if (!swept.used[s]) continue;
    for (const Sample& sample : *swept.sweeps[s].samples) {
      if (sample.joints <= joint) continue;
      const double turn = sample.angles_rad[joint] - *home;
      const double error = found.chain->angles[joint].curve_at(turn);
      lowest = any ? std::min(lowest, error) : error;
      highest = any ? std::max(highest, error) : error;
      from = any ? std::min(from, turn) : turn;
      to = any ? std::max(to, turn) : turn;
      any = true;
    }
  }
  return any ? std::optional(CurveSwing{highest - lowest, from, to}) : std::nullopt;
}

std::optional<Warning> told_otherwise(const Identification& found, std::size_t joint,
                                      double usual_mm) {
  if (auto turn = wrong_turn(found, joint, usual_mm)) return turn;
  return unlike_gears(found, joint);
}

}  // namespace identify
