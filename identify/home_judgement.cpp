#include "identify/home_judgement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "identify/chain/chain_start.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/sweeps/home.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// Joints come home to hundredths of a degree, which a metre away is a fraction of a millimetre.
constexpr double kOffHome_mm = 3;
constexpr double kOffHomeToPeers = 20;
constexpr std::size_t kFewestPeers = 3;    // two circles meet nearly anywhere
constexpr double kKnownHome_mm = 0.5;      // a circle that is known worse there tells nothing of it
constexpr double kLeastAtTarget_mm = 0.5;  // angles that are off by less there are no doubt
constexpr double kLeastStep_mm = 0.05;
/// A step explains a hundred times more than it leaves, with so many numbers to spare: by chance,
/// homes that scatter look so in one of some thousand campaigns (F of 3 and 4). With fewer to spare
/// it has to explain more, for the same chance.
constexpr double kExplainedByStep = 100;
constexpr double kUsualSpare = 4;
/// Gears err by minutes of arc; less is said and no doubt.
constexpr double kOffAngle_rad = 0.1 * kDegree;
constexpr double kLeastOffAngle_rad = 0.01 * kDegree;
/// Of what the other joints are off: homes that scatter make it in one of a thousand campaigns.
constexpr double kOffAngleToPeers = 10;
constexpr std::size_t kFewestNear = 3;
constexpr double kHomeSigmas = 5;
/// Locked joints that were told to stand elsewhere explain it themselves.
constexpr double kHeld_rad = 0.005 * kDegree;

constexpr const char* kSweepAgain =
    "Sweep all joints again, each from the same home, and touch nothing meanwhile";

AxisCircle circle_of(const CircleFit& circle) {
  return {{circle.normal, circle.center_mm},
          circle.center_mm + circle.radius_mm * circle.normal.unitOrthogonal()};
}

struct SeenCircle {
  AxisCircle circle;
  CircleCovariance known;
  std::size_t joint = 0;
  double time_s = 0;
};

std::vector<AxisCircle> circles_in(const std::vector<SeenCircle>& seen) {
  std::vector<AxisCircle> circles;
  circles.reserve(seen.size());
  for (const SeenCircle& one : seen) circles.push_back(one.circle);
  return circles;
}

/// One a sweep, in the order of time: of those that tell where home is.
std::vector<SeenCircle> circles_of_sweeps(const Identification& found) {
  std::vector<SeenCircle> seen;
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const JointResult& joint = found.joints[j];
    if (!joint.circle || joint.circle_target != found.joints.front().circle_target) continue;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      const Sweep& sweep = joint.sweeps[s];
      if (!joint.used[s] || sweep.target != joint.circle_target ||
          off_home_rad(sweep, found.home_rad) > kHeld_rad)
        continue;
      const auto points = positions(*sweep.samples);
      if (const auto usual = fit_usual_circle(points))
        seen.push_back({circle_of(usual->circle),
                        CircleCovariance(usual->circle, points, found.samples_per_independent()), j,
                        sweep.first().time_s});
    }
  }
  // Where a short arc's circle passes home, nobody knows.
  const Vector3d home = meeting_point(circles_in(seen));
  std::erase_if(seen, [&](const SeenCircle& one) {
    return !(kHomeSigmas * one.known.sigma_mm(home) < kKnownHome_mm);
  });
  std::stable_sort(seen.begin(), seen.end(),
                   [](const SeenCircle& a, const SeenCircle& b) { return a.time_s < b.time_s; });
  return seen;
}

/// Where the circles of some sweeps meet.
struct Meeting {
  std::vector<AxisCircle> circles;
  std::size_t visits = 0;  ///< to joints: a sweep there and back is one
  bool one_joint = true;   ///< met anywhere on its circle
  Vector3d at_mm = Vector3d::Zero();

  Meeting(const std::vector<SeenCircle>& seen, std::size_t from, std::size_t to,
          const Vector3d& near_mm) {
    for (std::size_t i = from; i < to; ++i) {
      circles.push_back(seen[i].circle);
      if (i == from || seen[i].joint != seen[i - 1].joint) ++visits;
      one_joint = one_joint && seen[i].joint == seen[from].joint;
    }
    at_mm = meeting_point(circles, near_mm);
  }
  [[nodiscard]] double left() const { return misfit(circles, at_mm); }
  /// Two numbers a visit, three of which the place takes up; a single circle both of its own.
  [[nodiscard]] double spare() const {
    return one_joint ? 2 * static_cast<double>(visits) - 2 : 2 * static_cast<double>(visits) - 3;
  }
};

/// From a joint's sweep on the target at home is elsewhere.
struct Step {
  double mm = 0;
  std::size_t joint = 0;
  std::optional<std::size_t> alone;  ///< the only joint on one side of it
  double time_s = 0;
};

Warning told(const Step& step, bool timed, const std::string& therefore) {
  if (step.alone)
    return {"off_home", step.alone,
            joint_name(*step.alone) + ": its circle passes " + brief(step.mm) +
                " mm from where the other joints' circles meet: another joint stood elsewhere than "
                "in the other sweeps, or the device, the robot's base or the target was moved. " +
                therefore + kSweepAgain};
  const std::string when = timed ? " on, at " + fixed(step.time_s, 1) + " s," : " on";
  return {"device_moved", step.joint,
          "from a sweep of " + joint_name(step.joint) + when + " the target at home is " +
              brief(step.mm) +
              " mm from where it was, and stays there: the device, the robot's base or the target "
              "was moved, or a joint did not come back home. " +
              therefore + kSweepAgain};
}

std::optional<Step> step_of_home(const Identification& found) {
  const auto seen = circles_of_sweeps(found);
  if (seen.size() < 2) return std::nullopt;
  const Meeting all(seen, 0, seen.size(), meeting_point(circles_in(seen)));
  double sigma_mm = 0;
  for (const SeenCircle& one : seen) sigma_mm = std::max(sigma_mm, one.known.sigma_mm(all.at_mm));
  double most = kUsualSpare * std::log(kExplainedByStep);
  std::optional<Step> step;
  for (std::size_t cut = 1; cut < seen.size(); ++cut) {
    Meeting before(seen, 0, cut, all.at_mm), after(seen, cut, seen.size(), all.at_mm);
    if (before.one_joint && after.one_joint) continue;
    if (before.one_joint) before.at_mm = meeting_point(before.circles, after.at_mm);
    if (after.one_joint) after.at_mm = meeting_point(after.circles, before.at_mm);
    const double spare = before.spare() + after.spare();
    const double moved = (after.at_mm - before.at_mm).norm();
    if (moved < kLeastStep_mm + kHomeSigmas * sigma_mm) continue;
    const double times = all.left() / (before.left() + after.left());
    const double evidence = spare * std::log(times);
    if (times < kExplainedByStep || evidence < most) continue;
    most = evidence;
    step = Step{moved, seen[cut].joint, {}, seen[cut].time_s};
    if (before.one_joint) step->alone = seen.front().joint;
    if (after.one_joint) step->alone = seen.back().joint;
  }
  return step;
}

/// What the chain allows for.
void tell_move(Identification& found, bool timed) {
  if (!found.chain || !found.chain->move) return;
  const ChainEstimate::MoveSeen& move = *found.chain->move;
  const Step step{move.mm.norm(), move.joint, move.alone, move.time_s};
  found.warnings.push_back(told(step, timed, "The result allows for it. "));
}

/// How certain a joint's circle is at a place.
double sigma_at(const Identification& found, std::size_t j, const Vector3d& place) {
  const JointResult& joint = found.joints[j];
  return CircleCovariance(*joint.circle, used_points(joint, joint.circle_target),
                          found.samples_per_independent())
      .sigma_mm(place);
}

/// A joint whose circle passes by where the others' meet, and by how far.
struct PassesBy {
  std::size_t joint = 0;
  double off_mm = 0;
};
std::optional<PassesBy> circle_that_passes_by(const Identification& found) {
  std::vector<AxisCircle> circles;
  std::vector<std::size_t> joints;
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const JointResult& joint = found.joints[j];
    if (!joint.circle || joint.circle_target != found.joints.front().circle_target) continue;
    circles.push_back(circle_of(*joint.circle));
    joints.push_back(j);
  }
  std::optional<PassesBy> worst;
  if (circles.size() <= kFewestPeers) return worst;
  double least = 0;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    auto others = circles;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Vector3d home = meeting_point(others);
    const double peers = std::sqrt(misfit(others, home) / static_cast<double>(others.size()));
    const double off = circles[i].to_circle(home).norm();
    if (!(off > kOffHome_mm) || !(off > kOffHomeToPeers * peers)) continue;
    if (!(off > kHomeSigmas * sigma_at(found, joints[i], home))) continue;
    if (worst && !(peers < least)) continue;
    worst = {joints[i], off};
    least = peers;
  }
  return worst;
}

/// Of a sweep's samples with its joint's angle the tenth nearest to home.
std::vector<const Sample*> nearest_to_home(const Sweep& sweep, std::size_t joint, double home_rad) {
  std::vector<const Sample*> samples;
  for (const Sample& sample : *sweep.samples)
    if (sample.joints > joint && sample.has_position) samples.push_back(&sample);
  const auto tenth = static_cast<std::ptrdiff_t>(samples.size() / 10);
  const auto off = [&](const Sample* one) { return std::abs(one->angles_rad[joint] - home_rad); };
  std::nth_element(samples.begin(), samples.begin() + tenth, samples.end(),
                   [&](const Sample* a, const Sample* b) { return off(a) < off(b); });
  samples.resize(static_cast<std::size_t>(tenth));
  return samples;
}

/// How far a joint's angles, as told while it swept, are from those at which the target was seen,
/// nearest to home; of its sweeps the farthest.
struct ToldOff {
  std::size_t joint = 0;
  double off_rad = 0;
  double noise_rad = 0;  ///< what noise may make of it
  double reach_mm = 0;   ///< from the axis to the target
  double peers_rad = 0;  ///< what other joints' usually are off

  [[nodiscard]] double off_mm() const { return off_rad * reach_mm; }
  /// Without what noise usually makes of it.
  [[nodiscard]] double beyond_noise_rad() const {
    const double usual = 2 / kHomeSigmas * noise_rad;
    return std::sqrt(std::max(0.0, off_rad * off_rad - usual * usual));
  }
};
std::optional<ToldOff> told_off(const Identification& found, std::size_t j) {
  const JointResult& joint = found.joints[j];
  if (!found.home_rad[j] || !(joint.line || joint.circle)) return std::nullopt;
  const Chain& chain = found.chain->chain;
  double sigma_mm = found.chain->noise.position_mm;
  if (joint.circle && joint.circle_target < chain.targets_mm.size())
    sigma_mm += sigma_at(found, j, chain.targets_mm[joint.circle_target]);
  std::optional<ToldOff> farthest;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
    const Sweep& sweep = joint.sweeps[s];
    if (!joint.used[s] || off_home_rad(sweep, found.home_rad) > kHeld_rad) continue;
    std::vector<double> off;  // from the first: they may lie about half a turn
    double first = 0;
    for (const Sample* sample : nearest_to_home(sweep, j, *found.home_rad[j])) {
      const auto seen = seen_turn(found, j, sweep.target, *sample);
      if (!seen || !seen->angle_error_rad) continue;
      if (off.empty()) first = *seen->angle_error_rad;
      off.push_back(wrapped(*seen->angle_error_rad - first));
    }
    if (off.size() < kFewestNear) continue;
    const double off_rad = std::abs(wrapped(first + mean_of_most(off)));
    // Each target has its own way to the axis, and what it is off by counts there.
    const ChainAxis& axis = chain.axes[j];
    const Vector3d arm = chain.targets_mm[sweep.target] - axis.point_mm;
    const double reach_mm = joint.line ? kLinear_mm : axis.direction.cross(arm).norm();
    if (!(reach_mm > 0) || (farthest && !(off_rad * reach_mm > farthest->off_mm()))) continue;
    farthest = {j, off_rad, kHomeSigmas * sigma_mm / reach_mm, reach_mm, 0};
  }
  return farthest;
}

/// A joint whose angles are off as the other joints' are not, as those that come late are.
std::optional<ToldOff> angle_off(const Identification& found) {
  std::vector<ToldOff> all;
  for (std::size_t j = 0; found.chain && j < found.joints.size(); ++j)
    if (const auto one = told_off(found, j)) all.push_back(*one);
  std::optional<ToldOff> worst;
  if (all.size() < kFewestPeers) return worst;
  for (ToldOff& one : all) {
    std::vector<double> others, others_mm;
    for (const ToldOff& other : all) {
      if (other.joint == one.joint) continue;
      others.push_back(other.beyond_noise_rad());
      others_mm.push_back(other.beyond_noise_rad() * other.reach_mm);
    }
    one.peers_rad = median_of(others);
    if (one.off_rad > kLeastOffAngle_rad + one.noise_rad &&
        one.off_rad > kOffAngleToPeers * one.peers_rad &&
        one.off_mm() > kOffAngleToPeers * median_of(others_mm) &&
        (!worst || one.off_mm() > worst->off_mm()))
      worst = one;
  }
  return worst;
}

}  // namespace

void judge_home(Identification& found, bool timed) {
  if (const auto one = circle_that_passes_by(found)) {
    found.doubts.push_back({"off_home", one->joint,
                            joint_name(one->joint) + ": its circle passes " +
                                fixed(one->off_mm, 1) +
                                " mm from where the other joints' circles meet: another joint "
                                "moved along, or stood elsewhere than in the other sweeps"});
    return;
  }
  if (const auto step = step_of_home(found)) {
    // Few circles meet where joints came home badly, and then elsewhere: a chain allows for that.
    const bool by_chain =
        found.estimator == Estimator::chain || (found.poses && found.poses->with_sweeps);
    if (!by_chain || step->mm > most_move_mm(found.chain->chain, known_of(found.chain->axes))) {
      found.doubts.push_back(told(*step, timed, ""));
      return;
    }
    if (!found.chain->move)
      found.warnings.push_back(told(*step, timed, "The result allows for homes that are off. "));
  }
  tell_move(found, timed);
  if (const auto one = angle_off(found)) {
    const bool linear = found.joints[one->joint].line.has_value();
    const bool doubtful = one->off_rad > kOffAngle_rad + one->noise_rad &&
                          one->off_rad > kOffHomeToPeers * one->peers_rad &&
                          one->off_mm() > kLeastAtTarget_mm;
    const std::string off =
        joint_name(one->joint) + (linear ? ": its places as told are " : ": its angles are ") +
        (linear ? "" : fixed(one->off_rad / kDegree, doubtful ? 2 : 3) + "°, ") +
        brief(one->off_mm()) + (linear ? " mm" : " mm at the target,") +
        " off where the target was seen, and the other joints' are not: robot, device or target "
        "were moved between the sweeps, or ";
    if (doubtful) {
      found.doubts.push_back(
          {"off_home", one->joint, off + "this joint's zero or scale is wrong. " + kSweepAgain});
      return;
    }
    found.warnings.push_back({"off_home", one->joint,
                              off + "its gear has play. It is known no better than that where it "
                                    "stands at home. Sweep all joints there and back"});
  }
  const double scatter = found.chain ? found.chain->home_scatter_mm : 0;
  if (scatter > kOffHome_mm)
    found.doubts.push_back({"off_home",
                            {},
                            "from sweep to sweep the target stood " + fixed(scatter, 1) +
                                " mm off home: another joint moved along, or robot or device were "
                                "moved"});
}

}  // namespace identify
