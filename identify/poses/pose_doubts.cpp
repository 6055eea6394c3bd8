#include "identify/poses/pose_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/line.hpp"
#include "identify/geometry/median.hpp"
#include "identify/poses/target_shift.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// With its zeros let go, a built arm is not so far from its description.
constexpr double kMisfit_mm = 8;
/// A mistake explains the poses where without it so much of the misfit is left, or less.
constexpr double kExplained = 0.2;
/// So many of the poses are enough to try it on.
constexpr std::size_t kTried = 60;
constexpr double kManyOutliers = 0.2;
/// Poses leave so much more beside sweeps than alone where they are of another place.
constexpr double kApartFromSweeps = 5;
/// Less is no other place: devices drift and joints play by as much.
constexpr double kLeastApart_mm = 0.05;
/// An arm that warms up moves by less.
constexpr double kMostWarming_mm = 0.5;
/// Of 24 files of still arms whose angles have two decimals and whose rests have three targets,
/// three seemed to be moved, by 1.5 times as much as poses are off (rms) at most. Moves of 0.1 mm
/// amid noise of 0.02 mm are 1.8 times as much, and more.
constexpr double kStandsOut = 1.7;
/// No device measures as badly, the middle one of all poses.
constexpr double kMostLeft_mm = 10;
constexpr std::size_t kMostNamed = 5;

struct Mistake {
  const char* code;
  std::string text;
  std::function<void(Pose&)> mend;
};

std::vector<Mistake> mistakes(std::size_t joints) {
  std::vector<Mistake> all;
  const auto scaled = [&](double factor, const char* text) {
    all.push_back({"unit_factor", text, [=](Pose& pose) { pose.sample.position_mm *= factor; }});
  };
  scaled(1000, "the positions are in metres, not in millimetres: correct the header");
  scaled(1e-3,
         "the positions are 1000 times too large, in micrometres or in mm under names in m: "
         "correct the header");
  scaled(25.4, "the positions are in inches, not in millimetres: correct them");
  const auto turned = [&](double factor, const char* text) {
    all.push_back({"unit_factor", text, [=](Pose& pose) {
                     for (double& angle : pose.sample.angles_rad) angle *= factor;
                   }});
  };
  turned(1 / kDegree, "the angles are in radians, not in degrees: correct the header");
  turned(kDegree, "the angles are in degrees, not in radians: correct the header");
  all.push_back({"frame_mirrored",
                 "the positions are in a left-handed frame: negate one coordinate, or exchange two",
                 [](Pose& pose) { pose.sample.position_mm.x() *= -1; }});
  for (std::size_t j = 0; j < joints; ++j)
    all.push_back({"angles_negated",
                   "the angles of " + joint_name(j) +
                       " have the other sign: negate them, or correct `positive` in the "
                       "description",
                   [j](Pose& pose) { pose.sample.angles_rad[j] *= -1; }});
  for (std::size_t i = 0; i < joints; ++i)
    for (std::size_t j = i + 1; j < joints; ++j)
      all.push_back({"joints_exchanged",
                     "the angles of " + joint_name(i) + " and " + joint_name(j) +
                         " are exchanged: exchange the columns",
                     [i, j](Pose& pose) {
                       std::swap(pose.sample.angles_rad[i], pose.sample.angles_rad[j]);
                     }});
  return all;
}

double misfit(const std::vector<Pose>& poses, const Campaign& campaign, std::size_t targets) {
  return middle_of(
      distances_mm(placed_robustly(*campaign.specified, Freedom::zeros, poses, targets), poses));
}

std::optional<Warning> contradiction(const std::vector<Pose>& poses, const Campaign& campaign) {
  if (!campaign.specified) return std::nullopt;
  std::vector<Pose> some;
  const std::size_t step = std::max<std::size_t>(1, poses.size() / kTried);
  std::size_t targets = 1;
  for (std::size_t i = 0; i < poses.size(); i += step) {
    some.push_back(poses[i]);
    targets = std::max(targets, poses[i].target + 1);
  }
  const double as_is = misfit(some, campaign, targets);
  if (as_is < kMisfit_mm) return std::nullopt;
  const auto all = mistakes(campaign.joints);
  std::vector<double> left;
  for (const Mistake& mistake : all) {
    auto mended = some;
    for (Pose& pose : mended) mistake.mend(pose);
    left.push_back(misfit(mended, campaign, targets));
  }
  const auto best = std::min_element(left.begin(), left.end());
  const double explained = kExplained * as_is;
  const std::string off = "the poses lie " + brief(as_is) +
                          " mm from where the described arm has them, its base, tool and zeros let "
                          "go";
  if (*best < explained) {
    const Mistake& likeliest = all[static_cast<std::size_t>(best - left.begin())];
    std::string text = off + "; it looks as if " + likeliest.text;
    bool alone = true;
    // The mirror image of a SCARA is that SCARA, with a third joint that goes the other way.
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (&all[k] == &likeliest || !(left[k] < std::min(explained, kMisfit_mm))) continue;
      text += ". Or " + all[k].text;
      alone = false;
    }
    if (!alone) text += ". See which of them it is";
    return Warning{likeliest.code, {}, std::move(text)};
  }
  return Warning{"pose_misfit",
                 {},
                 off +
                     ": check the description, the units, the order of the columns, that angles "
                     "and positions are of the same poses, and that several targets have names"};
}

/// At one place, by more than a device drifts, so that it stands out from what poses are off by; or
/// by more than an arm that warms up moves.
bool is_moved(const PoseEstimate& found) {
  const PoseStep& step = found.step;
  if (!step.seen) return false;
  if (step.moved_mm >= kMostWarming_mm) return true;
  return step.sudden && step.moved_mm >= std::max(kLeastApart_mm, kStandsOut * found.left.rms_mm);
}

Warning slipped(const PoseEstimate& found, const std::vector<Pose>& poses) {
  const PoseStep& step = found.step;
  const bool linear = found.chain.chain.axes[step.which].linear;
  return {"joint_slipped", step.which,
          "from " + poses[step.from].name + " on " + joint_name(step.which) + " stands " +
              (linear ? brief(std::abs(step.turned)) + " mm"
                      : brief(std::abs(step.turned) / kDegree) + "°") +
              " off where its reading says, and stood elsewhere before: it slipped, or its zero "
              "was set anew. See to the joint, and measure again"};
}

Warning told(const TargetShift& shift, const std::vector<Pose>& poses,
             const std::string& therefore) {
  return {"target_moved",
          {},
          "from " + poses[shift.from].name + " on the target is " + brief(shift.size_mm) +
              " mm away from where it was on the tool: " + therefore};
}

}  // namespace

std::vector<Pose> without_copies(std::vector<Pose> poses, std::vector<Warning>& warnings) {
  const auto same = [](const Pose& a, const Pose& b) {
    return a.target == b.target && a.sample.position_mm == b.sample.position_mm &&
           a.sample.angles_rad == b.sample.angles_rad;
  };
  const auto same_orientation = [](const Pose& a, const Pose& b) {
    return a.sample.has_orientation && a.sample.abc_rad == b.sample.abc_rad &&
           a.sample.angles_rad == b.sample.angles_rad;
  };
  std::vector<Pose> kept;
  std::size_t copies = 0;
  std::string first;
  for (Pose& pose : poses) {
    // Several targets of one stand have the tool's orientation beside each: it was measured once.
    if (std::any_of(kept.begin(), kept.end(),
                    [&](const Pose& one) { return same_orientation(one, pose); }))
      pose.sample.has_orientation = false;
    const auto other =
        std::find_if(kept.begin(), kept.end(), [&](const Pose& one) { return same(one, pose); });
    if (other == kept.end()) {
      kept.push_back(std::move(pose));
      continue;
    }
    if (++copies == 1) first = pose.name + " is " + other->name;
  }
  if (copies > 0)
    warnings.push_back({"pose_copies",
                        {},
                        std::to_string(copies) + " poses were given before, in every digit (" +
                            first + "): each was counted once"});
  return kept;
}

std::vector<Warning> doubts_of(const PoseEstimate& found, const std::vector<Pose>& poses,
                               const Campaign& campaign) {
  std::vector<Warning> doubts;
  if (auto contradicted = contradiction(poses, campaign)) {
    doubts.push_back(std::move(*contradicted));
    return doubts;
  }
  const PoseStep& step = found.step;
  const bool moved = is_moved(found);
  if (moved && step.of == PoseStep::Of::device)
    doubts.push_back({"device_moved",
                      {},
                      "from " + poses[step.from].name + " on the positions lie " +
                          brief(step.moved_mm) +
                          " mm elsewhere (rms), all as one body: the device or the robot's base "
                          "was moved there. Measure again, and touch nothing meanwhile"});
  if (moved && step.of == PoseStep::Of::joint) doubts.push_back(slipped(found, poses));
  const std::string therefore =
      "give the poses from there on a target name of their own, or measure again";
  if (doubts.empty())
    for (const TargetShift& shift : target_shifts(found, poses))
      if (shift.size_mm >= kLeastApart_mm) doubts.push_back(told(shift, poses, therefore));
  if (doubts.empty() && moved)
    doubts.push_back(told({.from = step.from, .size_mm = step.moved_mm}, poses, therefore));
  const double left_mm = middle_left_mm(found.fit);
  if (doubts.empty() && left_mm > std::max(kLeastApart_mm, kApartFromSweeps * found.left_alone_mm))
    doubts.push_back({"device_moved",
                      {},
                      "the poses lie " + brief(left_mm) +
                          " mm off the arm that the sweeps tell, and " +
                          brief(found.left_alone_mm) +
                          " mm off an arm of their own: the device, the robot's base or the target "
                          "was moved between the two. Measure both again, and touch nothing "
                          "meanwhile"});
  if (doubts.empty() && found.drift.seen && found.drift.moved_mm > kMostWarming_mm)
    doubts.push_back({"device_moved",
                      {},
                      "the first half of the poses and the second tell arms that are " +
                          brief(found.drift.moved_mm) +
                          " mm apart at the target (rms): the device, the robot's base or the "
                          "target was moved between them. Measure again, and touch nothing "
                          "meanwhile"});
  if (doubts.empty() && left_mm > kMostLeft_mm)
    doubts.push_back({"pose_outliers",
                      {},
                      "the poses lie " + brief(left_mm) +
                          " mm off any arm: the angles are not those of the positions, or several "
                          "targets were measured and have no names (column target)"});
  const auto outliers = static_cast<double>(found.outliers.size());
  if (doubts.empty() && outliers > kManyOutliers * static_cast<double>(poses.size()))
    doubts.push_back({"pose_outliers",
                      {},
                      std::to_string(found.outliers.size()) + " of " +
                          std::to_string(poses.size()) +
                          " poses lie far off: the angles are not those of the positions, or the "
                          "target was loose"});
  return doubts;
}

std::vector<Warning> advice_on(const PoseEstimate& found, const std::vector<Pose>& poses) {
  std::vector<Warning> advice;
  if (!found.outliers.empty()) {
    std::string names;
    for (std::size_t k = 0; k < std::min(kMostNamed, found.outliers.size()); ++k) {
      const std::size_t i = found.outliers[k];
      names += (names.empty() ? "" : ", ") + poses[i].name + " (" +
               brief(found.fit.rows[i].off.head<3>().norm()) + " mm)";
    }
    if (found.outliers.size() > kMostNamed) names += ", …";
    advice.push_back({"pose_outliers",
                      {},
                      std::to_string(found.outliers.size()) + " of " +
                          std::to_string(poses.size()) +
                          (found.outliers.size() == 1 ? " poses lies far off and hardly counts: "
                                                      : " poses lie far off and hardly count: ") +
                          names + ": look at them, or measure them again"});
  }
  if (found.drift.seen && found.drift.moved_mm <= kMostWarming_mm)
    advice.push_back({"poses_drift",
                      {},
                      "the first half of the poses and the second tell arms that are " +
                          brief(found.drift.moved_mm) +
                          " mm apart at the target (rms): the arm warmed up, or the device moved. "
                          "The numbers are of an arm between the two, and half of what parts "
                          "them is in the uncertainties: warm the arm up and measure again"});
  const PoseStep& step = found.step;
  if (step.seen && !found.drift.seen && !is_moved(found))
    advice.push_back({"poses_drift",
                      {},
                      "from " + poses[step.from].name + " on the positions lie " +
                          brief(step.moved_mm) +
                          " mm elsewhere (rms): the arm warmed up, or the device moved. What that "
                          "has the numbers off by is in the uncertainties: warm the arm up and "
                          "measure again"});
  // A device that drifts and a joint that plays do so, too.
  for (const TargetShift& shift : target_shifts(found, poses))
    if (shift.size_mm < kLeastApart_mm && !found.drift.seen && !step.seen)
      advice.push_back(told(shift, poses,
                            "it was moved, the device drifted, or a joint plays. The uncertainties "
                            "don't hold that. See that the target is tight, and measure again"));
  const ChainEstimate& chain = found.chain;
  for (std::size_t j = 0; j < chain.axes.size(); ++j) {
    // Where the fit went astray, nobody knows where axes are.
    if (chain.axes[j] || chain.chain.axes[j].linear || !found.fit.converged) continue;
    double radius = 0;
    for (const Vector3d& target : chain.chain.targets_mm) {
      const Vector3d arm = target - chain.chain.axes[j].point_mm;
      radius = std::max(radius, arm.cross(chain.chain.axes[j].direction).norm());
    }
    if (radius < kNearAxis_mm)
      advice.push_back({"target_near_axis", j,
                        joint_name(j) + ": the target is " + brief(radius) +
                            " mm from its axis, so that turning it hardly moves the target: put "
                            "the target 100 mm or more away from the axis"});
    else
      advice.push_back({"joint_not_turned", j,
                        joint_name(j) +
                            ": the poses leave its axis open: measure poses in which it turns "
                            "farther"});
  }
  const std::size_t rows = 3 * poses.size();
  const auto unknowns = static_cast<std::size_t>(found.fit.model.fixed_parameters());
  if (!found.with_sweeps && rows < 2 * unknowns)
    advice.push_back({"few_poses",
                      {},
                      std::to_string(poses.size()) + " poses are few for " +
                          std::to_string(unknowns) +
                          " unknowns: their noise is hardly known; measure " +
                          std::to_string((2 * unknowns + 2) / 3) + " or more"});
  return advice;
}

}  // namespace identify
