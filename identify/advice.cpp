#include "identify/advice.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>

#include "identify/chain/delay.hpp"
#include "identify/chain_advice.hpp"
#include "identify/circle/joint_motion.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/height_advice.hpp"
#include "identify/linear_advice.hpp"
#include "identify/specified_fit.hpp"
#include "identify/told_turn.hpp"

namespace identify {
namespace {

constexpr double kGoodRadius_mm = 100;
/// Without angles to hold it, a circle on so short an arc leans on every smooth error.
constexpr double kPoorArc_rad = 20 * kDegree;
constexpr double kLongestArc_rad = 330 * kDegree;
/// An axis so many times less certain than the others, on an arc shorter than this share of theirs.
constexpr double kUneven = 3;
constexpr double kShorter = 0.6;
/// The method asks for 10 % of 2 m/s.
constexpr double kSlow_mm_s = 200;
constexpr double kFast_mm_s = 500;
/// Printed more coarsely than this, positions and angles blur the result.
constexpr double kPoorResolution_mm = 0.0011;
constexpr double kPoorResolution_rad = 0.0011 * kDegree;
constexpr double kAdviceSigmas = 4;
constexpr double kLeastCurve_rad = 5 * kArcsec;
constexpr double kLeastCoherence = 8;

std::string degrees(double angle_rad) {
  return fixed(angle_rad / kDegree, 1) + "°";
}
std::string uncertain(double sigma_rad) {
  return brief(sigma_rad / kDegree) + "°";
}
std::string arcsec(double angle_rad) {
  return brief(angle_rad / kArcsec) + " arcsec";
}

/// Direction's uncertainty of an evenly sampled arc, its noise and radius 1.
double direction_sigma_of_arc(double arc_rad) {
  constexpr Eigen::Index kPoints = 201;
  CircleFit circle;
  circle.radius_mm = 1;
  Eigen::Matrix3Xd points(3, kPoints);
  for (Eigen::Index i = 0; i < kPoints; ++i) {
    const double angle = arc_rad * static_cast<double>(i) / (kPoints - 1);
    points.col(i) << std::cos(angle), std::sin(angle), 0;
  }
  Axis axis;
  axis.covariance = axis_covariance(circle, points, 1, 1);
  return axis.direction_sigma_rad();
}

/// What `sigma`, reached on an arc, becomes on another with as many samples.
double predicted(double sigma, double arc_rad, double other_arc_rad) {
  return sigma * direction_sigma_of_arc(other_arc_rad) / direction_sigma_of_arc(arc_rad);
}

class Adviser {
 public:
  Adviser(Identification& found, const Campaign& campaign) : found_(found), campaign_(campaign) {}

  void run() {
    for (std::size_t j = 0; j < found_.joints.size(); ++j) {
      if (found_.joints[j].line) advise_linear(j);
      if (!found_.joints[j].circle) {
        judge_by_poses(j);
        continue;
      }
      if (!judge_axis(j)) compare_with_others(j);
      judge_speed(j);
      if (found_.chain) judge_angles(j);
    }
    const bool by_chain = found_.chain && found_.estimator != Estimator::circle;
    const auto& measured = by_chain ? found_.chain->dh : found_.circle_dh;
    for (Warning& warning : advice_on_height(found_, measured, campaign_))
      found_.warnings.push_back(std::move(warning));
    judge_base();
    judge_resolution();
    if (campaign_.motion_limit)
      if (auto hidden = hidden_motion(found_, *campaign_.motion_limit))
        found_.warnings.push_back(std::move(*hidden));
    if (!found_.chain) return;
    for (Warning& warning : advice_on_chain(found_)) found_.warnings.push_back(std::move(warning));
  }

 private:
  void warn(std::string_view code, std::optional<std::size_t> joint, const std::string& message) {
    const std::string who = joint ? joint_name(*joint) + ": " : "";
    found_.warnings.push_back({std::string(code), joint, who + message});
  }

  [[nodiscard]] bool believed(std::size_t j) const {
    return found_.estimator == Estimator::chain &&
           found_.chain->angles[j].trust == AngleTrust::trusted;
  }

  /// Whether there was something to say.
  bool judge_axis(std::size_t j) {
    const JointResult& joint = found_.joints[j];
    const CircleFit& circle = *joint.circle;
    std::string seen = "radius " + fixed(circle.radius_mm, 1) + " mm";
    // Where noise runs round and round a point there is none.
    if (circle.arc_rad < 2 * kPi) seen += ", arc " + degrees(circle.arc_rad);
    const double sigma = joint.axis ? joint.axis->direction_sigma_rad() : 0;
    seen += joint.axis ? ", direction uncertain by " + uncertain(sigma)
                       : ", direction uncertain by more than 1°";
    if (circle.radius_mm < kNearAxis_mm) {
      std::string remedy = "choose a tool point further off it";
      if (joint.axis)
        remedy += ", " + fixed(kGoodRadius_mm, 0) + " mm would give about " +
                  uncertain(sigma * circle.radius_mm / kGoodRadius_mm);
      warn("target_near_axis", j,
           "the target point is close to the axis (" + seen + "): " + remedy);
      return true;
    }
    const bool lone = circle.arc_rad < kPoorArc_rad && !believed(j);
    // Where other explanations make axes uncertain, longer arcs would not help.
    const bool doubted = found_.chain && !found_.chain->others.empty();
    if (joint.axis && (sigma <= kPoorDirection_rad || doubted) && !lone) return false;
    std::string remedy = "sweep it further, or with a tool point further off the axis";
    if (joint.axis) {
      double arc = std::max(2 * circle.arc_rad, kPoorArc_rad);
      while (arc < kLongestArc_rad && predicted(sigma, circle.arc_rad, arc) > kPoorDirection_rad)
        arc += 5 * kDegree;
      arc = std::min(arc, kLongestArc_rad);
      if (arc > circle.arc_rad)
        remedy = "sweep it over " + degrees(arc) + ", that would give about " +
                 uncertain(predicted(sigma, circle.arc_rad, arc)) +
                 ", or choose a tool point further off the axis";
    }
    warn("arc_short", j, "the arc determines the axis poorly (" + seen + "): " + remedy);
    return true;
  }

  /// Of an axis that only static poses tell. What they contradict themselves by makes it uncertain,
  /// too.
  void judge_by_poses(std::size_t j) {
    const JointResult& joint = found_.joints[j];
    if (found_.estimator != Estimator::poses || !found_.doubts.empty() || !joint.axis ||
        joint.axis->linear || joint.axis->direction_sigma_rad() <= kPoorDirection_rad)
      return;
    std::vector<double> turns;
    for (const Pose& pose : found_.poses->poses)
      turns.push_back(found_.poses->fit.model.told(pose.sample)[j]);
    const auto [least, most] = std::minmax_element(turns.begin(), turns.end());
    warn("joint_hardly_turned", j,
         "the poses determine its axis poorly (it turns by " + degrees(*most - *least) +
             " among them, direction uncertain by " + uncertain(joint.axis->direction_sigma_rad()) +
             "): measure poses in which it turns farther, or more poses");
  }

  void compare_with_others(std::size_t j) {
    std::vector<double> sigmas;
    std::vector<double> arcs;
    for (std::size_t k = 0; k < found_.joints.size(); ++k) {
      const JointResult& other = found_.joints[k];
      if (k == j || !other.axis || !other.circle) continue;
      sigmas.push_back(other.axis->direction_sigma_rad());
      arcs.push_back(other.circle->arc_rad);
    }
    const JointResult& joint = found_.joints[j];
    if (sigmas.size() < 2 || !joint.axis) return;
    const double usual = median_of(std::move(sigmas));
    const double arc = median_of(std::move(arcs));
    const double sigma = joint.axis->direction_sigma_rad();
    if (!(usual > 0) || !(sigma > kUneven * usual) || !(joint.circle->arc_rad < kShorter * arc))
      return;
    warn("range_unbalanced", j,
         "its axis is " + brief(sigma / usual) + " times less certain than the others' (" +
             uncertain(sigma) + " on an arc of " + degrees(joint.circle->arc_rad) +
             "): sweeping it over " + degrees(arc) + " as well would give about " +
             uncertain(predicted(sigma, joint.circle->arc_rad, arc)));
  }

  void judge_speed(std::size_t j) {
    const auto moved = joint_motion(found_.joints[j]);
    if (!campaign_.timed || !moved || moved->speed_mm_s <= kFast_mm_s) return;
    warn("speed_high", j,
         "the target moved at " + fixed(moved->speed_mm_s, 0) + " mm/s, " +
             fixed(moved->step_mm, 1) +
             " mm from sample to sample: at such speed positions and angles of different moments, "
             "and vibration, spoil the accuracy; sweep at " +
             fixed(kSlow_mm_s, 0) + " mm/s or less");
  }

  void advise_linear(std::size_t j) {
    judge_speed(j);
    for (Warning& warning : advice_of_linear(found_, j, campaign_.resolution))
      found_.warnings.push_back(std::move(warning));
  }

  void judge_angles(std::size_t j) {
    const AngleEvidence& seen = found_.chain->angles[j];
    if (seen.samples == 0) return;
    const CircleFit& circle = *found_.joints[j].circle;
    const double backlash = std::abs(seen.backlash_rad);
    if (seen.backlash_sigma_rad > 0 && backlash > kAdviceSigmas * seen.backlash_sigma_rad &&
        backlash > campaign_.resolution.angle_rad)
      warn("backlash", j,
           "its error depends on the direction of the motion, by " + arcsec(backlash) + " or " +
               brief(backlash * circle.radius_mm) +
               " mm at the target: sweep it in one direction only, or look after the gear" +
               (seen.backlash_repeats ? ""
                                      : ". Sweep it there and back once more: that tells play from "
                                        "a joint that settles elsewhere each time"));
    if (seen.trust == AngleTrust::free)
      warn("angles_not_used", j,
           "its angles were not used, each of its circles stands by its points alone: " +
               seen.reason + " (error " + arcsec(seen.error_rms_rad) + " rms, " +
               arcsec(seen.expected_rms_rad) + " expected)");
    if (seen.trust == AngleTrust::smooth) judge_curve(j, seen);
  }

  void judge_curve(std::size_t j, const AngleEvidence& seen) {
    const JointResult& joint = found_.joints[j];
    const auto home = found_.home_rad[j];
    if (!home || !joint.axis || seen.coherence <= kLeastCoherence) return;
    const auto curve = curve_swing(found_, j);
    if (!curve) return;
    const double swing = curve->swing_rad;
    const Resolution& steps = campaign_.resolution;
    const auto moved = steps.time_s > 0 ? joint_motion(joint) : std::nullopt;
    const double of_stamps = moved ? steps.time_s * moved->speed_mm_s / joint.circle->radius_mm : 0;
    // At an even speed rounding, too, may go on smoothly, by a step in all.
    if (swing <= std::max({kLeastCurve_rad, steps.angle_rad, of_stamps,
                           2 * kAdviceSigmas * seen.center_sigma_rad}))
      return;
    warn("transmission_error", j,
         "its angles are off by a smooth curve of " + arcsec(swing) + " from lowest to highest (" +
             brief(swing * joint.circle->radius_mm) + " mm at the target) between " +
             degrees(*home + curve->from_rad) + " and " + degrees(*home + curve->to_rad) +
             ": they were not used; the curve is part of the result");
  }

  /// b and theta of row 1 tell where the frame of the positions is: in another one than the robot's
  /// own they say nothing of the arm.
  void judge_base() {
    const auto differences = compare_with_specified(found_.dh, found_.specified, found_.home_rad);
    if (campaign_.device_frame || !found_.doubts.empty() || differences.empty() ||
        found_.dh.front().linear)
      return;
    const double b_mm = differences.front().b_mm.value_or(0);
    const double theta_rad = differences.front().theta_rad.value_or(0);
    if (std::abs(b_mm) < kMostOff_mm && std::abs(theta_rad) < kMostOff_rad) return;
    warn("base_elsewhere", 0,
         "b of row 1 is " + fixed(b_mm, 1) + " mm and theta " + degrees(theta_rad) +
             " off the specified one: the positions are told in another frame than the robot's "
             "own, and these two numbers say where that is, not how the arm is. Take $NULLFRAME "
             "for BASE, or give a device's points without --frame robot");
  }

  void judge_resolution() {
    const Resolution& steps = campaign_.resolution;
    if (steps.position_mm <= kPoorResolution_mm && steps.angle_rad <= kPoorResolution_rad) return;
    std::string sizes;  // 0: there are none of these
    if (steps.position_mm > 0) sizes = fixed(steps.position_mm, 4) + " mm";
    if (steps.angle_rad > 0)
      sizes += (sizes.empty() ? "" : " and ") + fixed(steps.angle_rad / kDegree, 4) + "°";
    warn("low_precision", {},
         "numbers come in steps of " + sizes +
             ": have them written with four decimals or more (on a KUKA controller: Precision of "
             "the ETHERNET object)");
  }

  Identification& found_;
  const Campaign& campaign_;
};

}  // namespace

void add_advice(Identification& found, const Campaign& campaign) {
  Adviser(found, campaign).run();
}

void leave_out_consequences(Identification& found) {
  const auto is_one_of = [](const Warning& warning, std::initializer_list<const char*> codes) {
    return std::find(codes.begin(), codes.end(), warning.code) != codes.end();
  };
  const auto doubted = [&](std::initializer_list<const char*> codes) {
    return std::any_of(found.doubts.begin(), found.doubts.end(),
                       [&](const Warning& doubt) { return is_one_of(doubt, codes); });
  };
  const bool told_wrongly = doubted(
      {"unit_factor", "frame_mirrored", "angles_negated", "joints_exchanged", "targets_exchanged"});
  const bool moved = doubted({"device_moved", "target_moved"});
  std::erase_if(found.warnings, [&](const Warning& warning) {
    return (told_wrongly && is_one_of(warning, {"target_near_axis", "joint_not_turned",
                                                "pose_outliers", "poses_drift"})) ||
           (moved && is_one_of(warning, {"device_drifts"}));
  });
}

}  // namespace identify
