#include "identify/dh/axis_senses.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "identify/dh/joint_order.hpp"

namespace identify {
namespace {

/// In chi squared: what a plan weighs, and by how much the best has to be better than chance.
constexpr double kPlan = 16;
constexpr double kAsLikely = 12;
/// A robot is not hung upside down in its own frame.
constexpr double kOwnFrame = 25;

/// Senses in the order of the joints, those without an axis as given.
std::vector<int> by_joint(const JointOrder& order, std::size_t joints) {
  std::vector<int> senses(joints, 1);
  for (std::size_t i = 0; i < order.joints.size(); ++i) senses[order.joints[i]] = order.senses[i];
  return senses;
}

/// Senses that agree with the arm at the first pose where any do.
std::vector<JointOrder> fitting(const std::vector<Axis>& axes,
                                const std::vector<std::size_t>& joints, const Arm& arm,
                                const std::vector<std::vector<double>>& poses_rad) {
  for (const auto& pose : poses_rad)
    if (auto found = senses_that_fit(axes, joints, arm, pose); !found.fitting.empty())
      return std::move(found.fitting);
  return senses_that_fit(axes, joints, arm, std::nullopt).fitting;
}

}  // namespace

AxisSenses senses_of(const std::vector<std::optional<Axis>>& axes,
                     const std::vector<SenseBy>& known, const Arm& arm,
                     const std::vector<std::vector<double>>& poses_rad, bool device_frame) {
  std::vector<Axis> present;
  std::vector<std::size_t> joints;
  for (std::size_t j = 0; j < axes.size(); ++j)
    if (axes[j]) {
      present.push_back(*axes[j]);
      joints.push_back(j);
    }
  struct Scored {
    double score = 0;
    std::size_t turns = 0;  // of outer joints count more
    std::vector<int> senses;
  };
  std::vector<Scored> all;
  for (const JointOrder& order : fitting(present, joints, arm, poses_rad)) {
    Scored one{order.misfit, 0, by_joint(order, axes.size())};
    bool possible = true;
    for (std::size_t j = 0; j < axes.size(); ++j) {
      if (one.senses[j] > 0) continue;
      one.turns += std::size_t{1} << j;
      if (known[j] == SenseBy::angles) possible = false;
      if (known[j] == SenseBy::plan) one.score += kPlan;
    }
    if (!device_frame && axes.front() &&
        one.senses.front() * arm.positive.front() * axes.front()->direction.z() < 0)
      one.score += kOwnFrame;
    if (possible) all.push_back(std::move(one));
  }
  AxisSenses found{std::vector<int>(axes.size(), 1), {}, {}, {}};
  if (all.empty()) return found;
  double least = std::numeric_limits<double>::infinity();
  for (const Scored& one : all) least = std::min(least, one.score);
  std::erase_if(all, [&](const Scored& one) { return one.score > least + kAsLikely; });
  const auto best = std::min_element(
      all.begin(), all.end(), [](const Scored& a, const Scored& b) { return a.turns < b.turns; });
  found.senses = best->senses;
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const bool other_way = std::any_of(all.begin(), all.end(), [&](const Scored& one) {
      return one.senses[j] != best->senses[j];
    });
    if (other_way) found.ambiguous.push_back(j);
    if (known[j] == SenseBy::plan && best->senses[j] < 0) found.against.push_back(j);
  }
  for (const Scored& one : all)
    if (one.senses != best->senses) found.others.push_back(one.senses);
  return found;
}

}  // namespace identify
