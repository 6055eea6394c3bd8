#include "identify/chain_advice.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "identify/chain/chain_start.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/warning.hpp"

namespace identify {
namespace {

constexpr double kManyOutliers = 0.01;
constexpr double kManySamples = 10;    // a single independent one
constexpr double kRounding_mm = 1e-6;  // below it residuals are those of computing
/// Robots and trackers stay by about as much.
constexpr double kDrifts_mm = 0.02;
constexpr std::string_view kWarmUp =
    "The result allows for it. Let robot and device warm up before the sweeps";
constexpr std::string_view kThereAndBack =
    "Each joint was swept once, so nothing tells how far it went during a sweep, and "
    "uncertainties may be too small. Sweep each joint there and back";

class ChainAdviser {
 public:
  explicit ChainAdviser(const Identification& found) : found_(found), chain_(*found.chain) {}

  std::vector<Warning> run() {
    judge_samples();
    judge_unknown_joints();
    const bool ended = chain_.summary.converged;  // figures of what did not end may be anything
    if (ended) judge_uneven_joints(chain_.effects);
    for (Warning& one : joints_along(found_, false)) warnings_.push_back(std::move(one));
    if (ended && chain_.home_scatter_mm > kHomeScatter_mm)
      warn("home_not_shared", {},
           "from sweep to sweep the target stood off home by " + brief(chain_.home_scatter_mm) +
               " mm (1 sigma): keep the target where it is on the tool, lock the other joints at "
               "the same home for all sweeps, and do not touch the device; uncertainties allow for "
               "it");
    judge_drift();
    judge_strays();
    judge_others();
    judge_orientation();
    if (found_.poses && found_.poses->with_sweeps)
      judge_poses(found_.poses->fit.noise.position_mm, chain_.noise.position_mm);
    return std::move(warnings_);
  }

 private:
  void warn(std::string_view code, std::optional<std::size_t> joint, const std::string& message) {
    warnings_.push_back(
        {std::string(code), joint, (joint ? joint_name(*joint) + ": " : "") + message});
  }

  void judge_samples() {
    const auto samples = static_cast<double>(std::max<std::size_t>(1, chain_.samples));
    const double share = static_cast<double>(chain_.outliers) / samples;
    if (share > kManyOutliers)
      warn("outliers", {},
           std::to_string(chain_.outliers) + " of " + std::to_string(chain_.samples) +
               " samples (" + fixed(100 * share, 1) +
               (chain_.outliers == 1 ? " %) lies" : " %) lie") + " far off and hardly count" +
               (chain_.outliers == 1 ? "s" : "") +
               ": look for an interrupted line of sight or a "
               "loose target");
    if (chain_.samples_per_independent > kManySamples && chain_.noise.position_mm > kRounding_mm)
      warn("correlated_noise", {},
           "errors of successive samples are alike: " + fixed(chain_.samples_per_independent, 0) +
               " samples tell as much as one; uncertainties allow for it; more sweeps help, "
               "denser samples do not");
  }

  /// Which joints without an axis stood elsewhere than home in sweeps of others.
  void judge_unknown_joints() {
    const std::vector<bool> known = known_of(chain_.axes);
    for (std::size_t k = 0; k < known.size(); ++k) {
      if (known[k]) continue;
      std::vector<bool> others(known.size(), true);
      others[k] = false;
      std::size_t left_out = 0;
      for (std::size_t j = 0; j < known.size(); ++j)
        for (std::size_t s = 0; known[j] && s < found_.joints[j].sweeps.size(); ++s)
          if (const Sweep& sweep = found_.joints[j].sweeps[s];
              !found_.joints[j].used[s] && !sweep.positioning &&
              sweep.first().joints >= known.size() &&
              !tells_from_elsewhere(sweep, found_.home_rad, others))
            ++left_out;
      if (left_out > 0)
        warn("off_home", k,
             "it stood elsewhere than home in " + std::to_string(left_out) +
                 (left_out == 1 ? " sweep" : " sweeps") +
                 " of other joints, and its own axis is not known: they are left out. Sweep it, "
                 "too");
    }
  }

  void judge_uneven_joints(const ChainEffects& effects) {
    // By 10, 5 of 40 campaigns of even joints had one that seemed uneven.
    constexpr double kSure = 20;
    if (effects.creep_gain > kSure)
      warn("joints_creep", {},
           "while one joint swept, the locked ones went on by " +
               fixed(2 * effects.creep_rad / kDegree, 4) +
               "° (1 sigma) from the beginning of a sweep to its end. The uncertainties allow for "
               "it. Look after what holds the joints, and whether they rest before each sweep");
    for (std::size_t j = 0; j < effects.home_gains.size(); ++j) {
      const double home_rad = effects.home_rad_of(j);
      if (effects.home_gains[j] > kSure)
        warn("joint_not_held", j,
             "while it was locked it stood elsewhere from sweep to sweep, by " +
                 (found_.joints[j].linear ? brief(kLinear_mm * home_rad) + " mm"
                                          : fixed(home_rad / kDegree, 4) + "°") +
                 ", the other joints by " + fixed(effects.home_rad / kDegree, 4) +
                 "°: look after its brake and its gear");
      if (effects.figure_gains[j] > kSure)
        warn("arc_bent", j,
             "its arc departs from a circle " + brief(effects.figure_times_of(j)) +
                 " times as far as the other joints': look after its bearing, and whether another "
                 "joint moved along");
    }
  }

  void judge_drift() {
    // Joints that come back elsewhere seem to be some drift, too.
    const double mostly_mm = std::max(kDrifts_mm, chain_.home_scatter_mm / std::sqrt(2.0));
    const bool untold = chain_.effects.drift_mm >= mostly_mm && swept_once();
    const std::string_view remedy = untold ? kThereAndBack : kWarmUp;
    if (const auto& drift = chain_.steady_drift; drift && drift->mm.norm() >= kDrifts_mm) {
      const std::string within =
          drift->seconds > 0 ? ", in " + fixed(drift->seconds / 60, 1) + " min," : "";
      warn("device_drifts", {},
           "from the first sweep to the last one" + within + " the target drifted steadily by " +
               brief(drift->mm.norm()) + " mm. " + std::string(remedy));
    } else if (untold || (chain_.effects.drift_parts > 1 && chain_.wander_mm >= kDrifts_mm)) {
      warn("device_drifts", {},
           "during the sweeps the target " + std::string(untold ? "seems to have " : "") +
               "wandered by " + brief(chain_.wander_mm) + " mm (1 sigma). " + std::string(remedy));
    }
  }

  void judge_strays() {
    for (const auto& stray : chain_.strays)
      warn("sweep_disturbed", stray.joint,
           "its sweep " + std::to_string(stray.number + 1) + " of " + std::to_string(stray.of) +
               " does not go with the others, by about " + brief(stray.mm) +
               " mm: something moved while it ran, and it hardly counts. Look for a joint that "
               "gives way, or for what touched target or device, and sweep the joint again");
  }

  /// Of each kind the likeliest.
  void judge_others() {
    bool moved = false, disturbed = false;
    for (const auto& other : chain_.others) {
      if (!std::exchange(other.moved ? moved : disturbed, true))
        warn("other_explanation", other.joint, words_of(other));
    }
  }

  static std::string words_of(const ChainEstimate::OtherExplanation& other) {
    const std::string sweep =
        "its sweep " + std::to_string(other.number + 1) + " of " + std::to_string(other.of);
    const std::string about = " by about " + brief(other.mm) + " mm";
    const std::string otherwise =
        ". What the result assumes in its place, as that joints do not come back home, explains "
        "what was seen about as well. The uncertainties allow for both. ";
    if (other.moved)
      return "before or during " + sweep +
             " the device, the robot's base or the target may have been moved" + about + otherwise +
             "Sweep the first joints once more at the end: that tells them apart";
    return sweep + " may be off" + about + ", since something gave way while it ran" + otherwise +
           "Sweep the joint again";
  }

  /// Every joint, so that nothing tells what moves during a sweep from what the arm does.
  [[nodiscard]] bool swept_once() const {
    return std::none_of(found_.joints.begin(), found_.joints.end(), [](const JointResult& joint) {
      std::set<std::size_t> targets;
      for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
        if (joint.used[s] && !targets.insert(joint.sweeps[s].target).second) return true;
      return false;
    });
  }

  void judge_orientation() {
    const bool trusted =
        std::any_of(chain_.angles.begin(), chain_.angles.end(),
                    [](const AngleEvidence& seen) { return seen.trust == AngleTrust::trusted; });
    if (chain_.with_orientation || !trusted) return;
    bool any = false;
    for (const JointResult& joint : found_.joints)
      for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
        if (!joint.used[s]) continue;
        for (const Sample& sample : *joint.sweeps[s].samples) {
          if (!sample.has_orientation) return;
          any = true;
        }
      }
    if (any)
      warn("orientation_inconsistent", {},
           "the tool's orientations contradict positions and angles and were not used: check that "
           "A, B, C are those of the same tool and base, R = Rz(A) Ry(B) Rx(C)");
  }

  /// The same device saw both.
  void judge_poses(double poses_mm, double samples_mm) {
    constexpr double kNoisier = 4, kLeast_mm = 0.05;
    if (poses_mm > std::max(kLeast_mm, kNoisier * samples_mm))
      warn("poses_noisy", {},
           "the poses scatter by " + brief(poses_mm) + " mm, the sweeps' samples by " +
               brief(samples_mm) +
               " mm: the device, the robot's base or the target was moved between the two, or "
               "joints do more than the model has. Measure some poses again, and 30 or more");
  }

  const Identification& found_;
  const ChainEstimate& chain_;
  std::vector<Warning> warnings_;
};

}  // namespace

std::vector<Warning> joints_along(const Identification& found, bool beyond) {
  // What a joint gives way under another one's weight is less.
  constexpr double kGivesWay_rad = 0.1 * kDegree;
  std::vector<Warning> warnings;
  if (!found.chain) return warnings;
  for (std::size_t swept = 0; swept < found.joints.size(); ++swept) {
    std::string told;
    double likeliest_rad = 0;
    for (const ChainEffects::Along& one : found.chain->effects.along) {
      if (one.swept != swept) continue;
      const double rad = 2 * one.rad;  // from the beginning of a sweep to its end
      if (told.empty()) likeliest_rad = rad;
      told += (told.empty() ? "" : " or ") + joint_name(one.joint) + " by about " +
              (found.joints[one.joint].linear ? brief(kLinear_mm * rad) + " mm"
                                              : brief(rad / kDegree) + "°");
    }
    if (told.empty() || (likeliest_rad > kGivesWay_rad) != beyond) continue;
    warnings.push_back({"joint_along", swept,
                        joint_name(swept) + ": while it was swept, another joint went along: " +
                            told + ". Look after what holds it, and sweep this joint again"});
  }
  return warnings;
}

std::vector<Warning> advice_on_chain(const Identification& found) {
  return ChainAdviser(found).run();
}

}  // namespace identify
