#include "identify/poses/target_exchange.hpp"

#include <algorithm>
#include <functional>
#include <string>

#include "identify/poses/arm_fit.hpp"
#include "identify/poses/pose_start.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// A built arm is not so far from its description, and targets are no closer to each other.
constexpr double kFarFromOwn_mm = 8;
/// Of how far a pose lies from its own target, so much is left at another one, or less.
constexpr double kAtAnother = 0.2;
/// One is a slip of another kind, perhaps.
constexpr std::size_t kFewestExchanged = 2;
constexpr std::size_t kExchangedNamed = 5;

/// Where a target is at a pose.
using Predicted = std::function<Vector3d(const Pose& pose, std::size_t target)>;

struct Exchanged {
  std::vector<std::size_t> poses;
  double own_mm = 0, other_mm = 0;  ///< means
};

Exchanged exchanged(const std::vector<Pose>& poses, std::size_t targets,
                    const Predicted& predicted) {
  Exchanged all;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto off_mm = [&](std::size_t target) {
      return (poses[i].sample.position_mm - predicted(poses[i], target)).norm();
    };
    const double own = off_mm(poses[i].target);
    double other = own;
    for (std::size_t t = 0; t < targets; ++t) other = std::min(other, off_mm(t));
    if (own < kFarFromOwn_mm || other > kFarFromOwn_mm || other > kAtAnother * own) continue;
    all.poses.push_back(i);
    all.own_mm += own;
    all.other_mm += other;
  }
  all.own_mm /= std::max<double>(1, static_cast<double>(all.poses.size()));
  all.other_mm /= std::max<double>(1, static_cast<double>(all.poses.size()));
  return all;
}

}  // namespace

std::optional<Warning> exchanged_targets(const PoseEstimate& found, const std::vector<Pose>& poses,
                                         const Campaign& campaign, const ChainEstimate* sweeps) {
  const std::size_t targets = found.fit.model.chain.targets_mm.size();
  if (targets < 2) return std::nullopt;
  Exchanged seen;
  if (found.with_sweeps && whole(sweeps)) {
    PoseModel model;
    model.chain = sweeps->chain;
    model.home_rad = found.fit.model.home_rad;
    seen = exchanged(poses, model.chain.targets_mm.size(), [&](Pose pose, std::size_t target) {
      pose.target = std::min(target, model.chain.targets_mm.size() - 1);
      return model.position_mm(pose);
    });
  }
  if (seen.poses.size() < kFewestExchanged && campaign.specified) {
    const PlacedArm arm = placed_robustly(*campaign.specified, Freedom::zeros, poses, targets);
    seen = exchanged(poses, targets, [&](const Pose& pose, std::size_t target) {
      return arm.position_mm(target, pose.sample);
    });
  }
  if (seen.poses.size() < kFewestExchanged) return std::nullopt;
  std::string names;
  for (std::size_t k = 0; k < std::min(kExchangedNamed, seen.poses.size()); ++k)
    names += (k == 0 ? "" : ", ") + poses[seen.poses[k]].name;
  if (seen.poses.size() > kExchangedNamed) names += ", …";
  return Warning{"targets_exchanged",
                 {},
                 std::to_string(seen.poses.size()) + " of " + std::to_string(poses.size()) +
                     " poses lie " + brief(seen.own_mm) + " mm from where their target is, and " +
                     brief(seen.other_mm) +
                     " mm from another target of the tool: the targets' names look exchanged. "
                     "Correct them: " +
                     names};
}

}  // namespace identify
