#include "identify/home_judgement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "identify/chain/chain_start.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/sweeps/home.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// Joints come home to hundredths of a degree, which a metre away is a fraction of a millimetre.
constexpr double kOffHome_mm = 3;
constexpr double kOffHomeToPeers = 20;
constexpr std::size_t kFewestPeers = 3;  // two circles meet nearly anywhere
/// Steps of brakes and of targets that settle are smaller, and the uncertainties hold them.
constexpr double kStep_mm = 0.5;
/// A step explains a hundred times more than it leaves, with so many numbers to spare: by chance,
/// homes that scatter look so in one of some thousand campaigns (F of 3 and 4).
constexpr double kExplainedByStep = 100;
constexpr std::size_t kFewestSpare = 4;
/// Locked joints that were told to stand elsewhere explain it themselves.
constexpr double kHeld_rad = 0.005 * kDegree;

AxisCircle circle_of(const CircleFit& circle) {
  return {{circle.normal, circle.center_mm},
          circle.center_mm + circle.radius_mm * circle.normal.unitOrthogonal()};
}

struct SeenCircle {
  AxisCircle circle;
  std::size_t joint = 0;
  double time_s = 0;
};

/// One a sweep, in the order of time.
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
      const auto circle = fit_usual_circle(positions(*sweep.samples));
      if (circle) seen.push_back({circle_of(circle->circle), j, sweep.first().time_s});
    }
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const SeenCircle& a, const SeenCircle& b) { return a.time_s < b.time_s; });
  return seen;
}

/// Where circles of two joints or more meet.
struct Meeting {
  Vector3d at_mm;
  double misfit = 0;
};
std::optional<Meeting> meeting_of(const std::vector<SeenCircle>& seen, std::size_t from,
                                  std::size_t to, const Vector3d& start) {
  std::set<std::size_t> joints;
  std::vector<AxisCircle> circles;
  for (std::size_t i = from; i < to; ++i) {
    joints.insert(seen[i].joint);
    circles.push_back(seen[i].circle);
  }
  if (joints.size() < 2) return std::nullopt;
  const Vector3d at = meeting_point(circles, start);
  return Meeting{at, misfit(circles, at)};
}

std::optional<Warning> step_of_home(const Identification& found, bool timed) {
  const auto seen = circles_of_sweeps(found);
  if (2 * seen.size() < 6 + kFewestSpare) return std::nullopt;
  std::vector<AxisCircle> circles;
  for (const SeenCircle& one : seen) circles.push_back(one.circle);
  const Vector3d home = meeting_point(circles);
  double least = misfit(circles, home) / kExplainedByStep, moved_mm = 0;
  std::size_t from = 0;
  for (std::size_t cut = 2; cut + 2 <= seen.size(); ++cut) {
    const auto before = meeting_of(seen, 0, cut, home);
    const auto after = meeting_of(seen, cut, seen.size(), home);
    if (!before || !after || !(before->misfit + after->misfit < least)) continue;
    least = before->misfit + after->misfit;
    moved_mm = (after->at_mm - before->at_mm).norm();
    from = cut;
  }
  if (!(moved_mm > kStep_mm)) return std::nullopt;
  const std::string when = timed ? " on, at " + fixed(seen[from].time_s, 1) + " s," : " on";
  return Warning{"device_moved", seen[from].joint,
                 "from a sweep of " + joint_name(seen[from].joint) + when +
                     " the target at home is " + brief(moved_mm) +
                     " mm from where it was, and stays there: the device, the robot's base or the "
                     "target was moved, or a joint did not come back home. Sweep all joints again, "
                     "each from the same home, and touch nothing meanwhile"};
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
    if (worst && !(peers < least)) continue;
    worst = {joints[i], off};
    least = peers;
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
  if (auto step = step_of_home(found, timed)) {
    found.doubts.push_back(std::move(*step));
    return;
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
