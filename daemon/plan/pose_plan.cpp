#include "daemon/plan/pose_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/halton.hpp"
#include "identify/poses/pose_design.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using Angles = std::vector<double>;

constexpr std::size_t kMostTriesEach = 50;
constexpr std::size_t kWorkspace = 500;
constexpr std::size_t kBlindDraws = 20;
constexpr double kOpenRange_deg = 90;
constexpr int kPoseDecimals = 3;

Angles pose_in_radians(Angles angles_deg) {
  for (double& angle : angles_deg) angle = radians(angle);
  return angles_deg;
}

/// Which angles joints may take, deg.
struct JointRanges {
  std::vector<double> low, high;

  JointRanges(const RobotDescription& robot, double margin_deg) {
    for (std::size_t j = 0; j < robot.joints(); ++j) {
      const JointLimits& limits = robot.limits[j];
      const bool known = std::isfinite(limits.min_deg) && std::isfinite(limits.max_deg);
      low.push_back(known ? limits.min_deg + margin_deg : robot.home_deg[j] - kOpenRange_deg);
      high.push_back(known ? limits.max_deg - margin_deg : robot.home_deg[j] + kOpenRange_deg);
      if (low.back() >= high.back())
        throw std::invalid_argument(fmt::format(
            "--margin-deg {}: joint {} may turn from {} to {} {}: give a smaller margin",
            margin_deg, j + 1, limits.min_deg, limits.max_deg, limits.unit()));
    }
  }

  [[nodiscard]] Angles pose(std::size_t index) const {
    Angles angles = identify::halton_point(index, low.size());
    for (std::size_t j = 0; j < angles.size(); ++j)
      angles[j] = rounded(low[j] + (high[j] - low[j]) * angles[j], kPoseDecimals);
    return angles;
  }
};

std::string removed_words(const PosePlan& plan) {
  std::string text;
  for (std::size_t rule = 0; rule < kPoseRules; ++rule)
    if (plan.removed[rule] > 0)
      text += (text.empty() ? "" : "; ") + words(static_cast<PoseRule>(rule)) + ": " +
              std::to_string(plan.removed[rule]);
  return text;
}

std::vector<Angles> allowed_poses(const RobotDescription& robot, const PoseRules& rules,
                                  PosePlan& plan) {
  const JointRanges ranges(robot, plan.task.limits.margin_deg);
  std::vector<Angles> allowed;
  const std::size_t most = kMostTriesEach * plan.task.candidates;
  while (allowed.size() < plan.task.candidates && plan.tried < most) {
    const Angles angles_deg = ranges.pose(++plan.tried);
    if (const auto rule = rules.broken(pose_in_radians(angles_deg)))
      ++plan.removed[static_cast<std::size_t>(*rule)];
    else
      allowed.push_back(angles_deg);
  }
  if (allowed.size() < plan.task.count)
    throw std::runtime_error(fmt::format(
        "--poses {}: of {} within the joint limits {} allowed ({}): move the device, open the "
        "cone, or make the boxes smaller",
        plan.task.count, rsi::counted(plan.tried, "pose"),
        allowed.empty() ? "none is" : fmt::format("only {} are", allowed.size()),
        removed_words(plan)));
  return allowed;
}

/// How long a move takes, all joints beginning and ending together.
double move_s(const Angles& from_deg, const Angles& to_deg, double speed_deg_s) {
  double most = 0;
  for (std::size_t j = 0; j < from_deg.size(); ++j)
    most = std::max(most, std::abs(to_deg[j] - from_deg[j]));
  return most / speed_deg_s;
}

/// The nearest next one that can be reached straight; over home where there is none.
void put_in_order(std::vector<Angles> left, const PoseRules& rules, PosePlan& plan) {
  const double speed = plan.task.speed_deg_s;
  Angles at = plan.home_deg;
  while (!left.empty()) {
    std::sort(left.begin(), left.end(), [&](const Angles& one, const Angles& other) {
      return move_s(at, one, speed) > move_s(at, other, speed);
    });
    auto next = std::find_if(left.rbegin(), left.rend(), [&](const Angles& one) {
      return rules.free_way(pose_in_radians(at), pose_in_radians(one));
    });
    const bool over_home = next == left.rend();
    if (over_home) {
      next = left.rbegin();
      plan.duration_s += move_s(at, plan.home_deg, speed);
      at = plan.home_deg;
    }
    plan.duration_s += move_s(at, *next, speed) + plan.task.dwell_s;
    at = *next;
    plan.poses.push_back({at, over_home});
    left.erase(std::next(next).base());
  }
  plan.duration_s += move_s(at, plan.home_deg, speed);
}

identify::PoseOutlook blind_outlook(const identify::PoseForecast& forecast,
                                    const std::vector<identify::PoseRow>& rows,
                                    const std::vector<identify::PoseRow>& workspace,
                                    std::size_t count) {
  std::mt19937 random(1);
  std::vector<identify::PoseOutlook> outlooks;
  for (std::size_t draw = 0; draw < kBlindDraws; ++draw) {
    std::vector<identify::PoseRow> drawn;
    std::sample(rows.begin(), rows.end(), std::back_inserter(drawn), count, random);
    outlooks.push_back(forecast.outlook(drawn, workspace));
  }
  return mean(outlooks);
}

void check_task(const RobotDescription& robot, const PoseTask& task) {
  if (!robot.arm)
    throw std::runtime_error(
        "the robot description has no DH table: poses are chosen by one, write it from a data "
        "sheet");
  const std::size_t fewest = identify::fewest_poses(robot.joints());
  if (task.count < fewest)
    throw std::invalid_argument(
        fmt::format("--poses {}: {} need {} poses at least: ask for {}, better 30 or more",
                    task.count, rsi::counted(robot.joints(), "joint"), fewest, fewest));
}

}  // namespace

std::size_t PosePlan::allowed() const {
  return tried - std::accumulate(removed.begin(), removed.end(), std::size_t{0});
}

identify::Campaign campaign_of_poses(const RobotDescription& robot) {
  identify::Campaign campaign;
  campaign.joints = robot.joints();
  campaign.specified = robot.arm;
  campaign.device_frame = true;
  campaign.loads = robot.loads;
  campaign.up = robot.up;
  return campaign;
}

PosePlan plan_poses(const RobotDescription& robot, const PoseTask& task,
                    const OnPlanned& on_progress) {
  check_task(robot, task);
  const PoseRules rules(*robot.arm, task.limits);
  if (const auto rule = rules.in_the_way(robot.arm->home_rad))
    throw std::runtime_error("home_deg of the robot description is forbidden (" + words(*rule) +
                             "): choose another home, or change the box, floor or column");
  PosePlan plan;
  plan.task = task;
  plan.home_deg = robot.home_deg;
  for (std::size_t j = 0; j < robot.joints(); ++j)
    if (!std::isfinite(robot.limits[j].min_deg) || !std::isfinite(robot.limits[j].max_deg))
      plan.without_limits.push_back(j);
  const auto done = [&](double share) {
    if (on_progress) on_progress(share, 1);
  };
  const std::vector<Angles> allowed = allowed_poses(robot, rules, plan);
  done(0.2);

  const identify::PoseForecast forecast(campaign_of_poses(robot),
                                        {.position_mm = task.position_sigma_mm,
                                         .orientation_rad = 0,
                                         .joint_rad = radians(task.joint_sigma_deg)});
  std::vector<identify::PoseRow> rows, workspace, chosen_rows;
  std::vector<Eigen::MatrixXd> candidates;
  for (const Angles& angles_deg : allowed) {
    rows.push_back(forecast.row(pose_in_radians(angles_deg)));
    candidates.push_back(forecast.candidate(rows.back()));
  }
  const JointRanges ranges(robot, task.limits.margin_deg);
  for (std::size_t k = 1; k <= kWorkspace; ++k)
    workspace.push_back(forecast.row(pose_in_radians(ranges.pose(k))));
  std::vector<Angles> chosen;
  for (const std::size_t k : identify::d_optimal(candidates, task.count)) {
    chosen.push_back(allowed[k]);
    chosen_rows.push_back(rows[k]);
  }
  done(0.8);
  plan.outlook = forecast.outlook(chosen_rows, workspace);
  plan.at_random = blind_outlook(forecast, rows, workspace, task.count);
  put_in_order(std::move(chosen), rules, plan);
  done(1);
  return plan;
}

}  // namespace sweepd
