#include "daemon/plan/plan_proposal.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace sweepd {
namespace {

using identify::DhEstimate;

constexpr double kWidest_deg = 340;
constexpr double kLeastGain = 1.1;
constexpr std::chrono::milliseconds kCoarseCycle{16};

double range_deg(const PlannedSweep& sweep) {
  return std::abs(sweep.end_deg - sweep.start_deg);
}

/// The joint's longest sweep in the plan; nothing if it has none.
std::optional<std::size_t> longest(const SweepPlan& plan, std::size_t joint) {
  std::optional<std::size_t> found;
  for (std::size_t s = 0; s < plan.sweeps.size(); ++s)
    if (plan.sweeps[s].joint == joint &&
        (!found || range_deg(plan.sweeps[s]) > range_deg(plan.sweeps[*found])))
      found = s;
  return found;
}

bool same(const PlannedSweep& a, const PlannedSweep& b) {
  return a.start_deg == b.start_deg && a.end_deg == b.end_deg;
}

}  // namespace

SweepPlan widened(const SweepPlan& plan, std::size_t joint, const RobotDescription& robot,
                  double margin_deg) {
  SweepPlan wider = plan;
  const auto index = longest(plan, joint);
  const JointLimits& limits = robot.limits[joint - 1];
  if (!index || !std::isfinite(limits.min_deg) || !std::isfinite(limits.max_deg)) return wider;
  PlannedSweep& sweep = wider.sweeps[*index];
  const auto [low, high] = std::minmax(sweep.start_deg, sweep.end_deg);
  double from = std::min(low, limits.min_deg + margin_deg);
  double to = std::max(high, limits.max_deg - margin_deg);
  if (!limits.linear && to - from > kWidest_deg) {
    if (high - low >= kWidest_deg) return wider;
    // About the old middle, but within the limits.
    from = std::clamp((low + high - kWidest_deg) / 2, from, to - kWidest_deg);
    to = from + kWidest_deg;
  }
  const bool rising = sweep.end_deg > sweep.start_deg;
  sweep.start_deg = rising ? from : to;
  sweep.end_deg = rising ? to : from;
  return wider;
}

double gain(const identify::Prediction& before, const identify::Prediction& after) {
  double sum = 0;
  int both = 0;
  int more = 0;
  for (std::size_t j = 0; j < before.dh.size(); ++j)
    for (const auto& of : identify::kDhNumbers) {
      const auto& first = before.dh[j].*of.number;
      const auto& second = after.dh[j].*of.number;
      const bool in_first = first.knowledge == identify::Knowledge::identified;
      const bool in_second = second.knowledge == identify::Knowledge::identified;
      more += in_second - in_first;
      if (!in_first || !in_second || !(first.sigma > 0) || !(second.sigma > 0)) continue;
      sum += std::log(first.sigma / second.sigma);
      ++both;
    }
  if (more != 0) return more > 0 ? std::numeric_limits<double>::infinity() : 0;
  return both > 0 ? std::exp(sum / both) : 1;
}

Proposal propose(const RobotDescription& robot, const PlanOutlook& from,
                 const Measurement& measurement, double margin_deg,
                 const std::function<void(double done, double total)>& progress) {
  Proposal proposal{{}, from};
  std::set<std::size_t> open;
  for (std::size_t joint = 1; joint <= robot.joints(); ++joint) open.insert(joint);
  const auto joints = static_cast<double>(robot.joints());
  double done = 0;
  // Information grows with the number of samples alike for all plans: few are enough to compare.
  Measurement coarse = measurement;
  coarse.cycle = std::max(measurement.cycle, kCoarseCycle);
  PlanOutlook reached = look_ahead(robot, from.plan, coarse, 1);
  while (!open.empty()) {
    std::optional<PlanOutlook> best;
    std::size_t best_joint = 0;
    double best_gain = kLeastGain;
    for (const std::size_t joint : std::set<std::size_t>(open)) {
      if (progress) progress(done++, joints * (joints + 1) / 2);
      const auto index = longest(from.plan, joint);
      SweepPlan plan = widened(reached.plan, joint, robot, margin_deg);
      if (!index || same(plan.sweeps[*index], from.plan.sweeps[*index])) {
        open.erase(joint);
        continue;
      }
      PlanOutlook outlook = look_ahead(robot, plan, coarse, 1);
      const double gained = gain(reached.prediction, outlook.prediction);
      if (gained < best_gain) continue;
      best_gain = gained;
      best_joint = joint;
      best = std::move(outlook);
    }
    if (!best) break;
    const std::size_t index = *longest(from.plan, best_joint);
    proposal.steps.push_back({from.plan.sweeps[index], best->plan.sweeps[index], best_gain});
    reached = *std::move(best);
    open.erase(best_joint);
  }
  if (!proposal.steps.empty()) proposal.outlook = look_ahead(robot, reached.plan, measurement);
  return proposal;
}

}  // namespace sweepd
