#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "daemon/plan/pose_rules.hpp"
#include "daemon/plan/simulated_robot.hpp"
#include "daemon/settings/robot_description.hpp"
#include "identify/poses/pose_outlook.hpp"

namespace sweepd {

/// Static poses that are to be chosen, and how they will be measured and driven.
struct PoseTask {
  std::size_t count = 0;
  PoseLimits limits;
  double position_sigma_mm = 0.02;            ///< of the device, each coordinate
  double joint_sigma_deg = kUsualWobble_deg;  ///< of each joint from its angle, anew at each pose
  double speed_deg_s = 20;                    ///< of every axis, mm/s of linear ones
  double dwell_s = 2;
  std::size_t candidates = 1000;  ///< so many allowed poses are chosen from
};

struct PlannedPose {
  std::vector<double> angles_deg;  ///< to 0.001; mm of linear joints
  bool over_home = false;          ///< the straight way from the pose before is not free
};

/// Poses in the order in which they are driven, and what they will tell.
struct PosePlan {
  PoseTask task;
  std::vector<double> home_deg;
  std::vector<PlannedPose> poses;
  std::size_t tried = 0;                          ///< evenly spread within the joint limits
  std::array<std::size_t, kPoseRules> removed{};  ///< of them, by which rule
  std::vector<std::size_t> without_limits;        ///< joints from 0: 90 degrees from home are taken
  identify::PoseOutlook outlook;
  identify::PoseOutlook at_random;  ///< as many allowed poses drawn blindly, mean variances
  double duration_s = 0;            ///< of moves and rests, accelerations aside

  [[nodiscard]] std::size_t allowed() const;
};

/// Told how much is done, of how much.
using OnPlanned = std::function<void(double done, double total)>;

/// D-optimal poses out of a low-discrepancy sequence within the joint limits, in the order of the
/// nearest next one. Deterministic. Throws std::invalid_argument where there are fewer than
/// the unknowns need; std::runtime_error where the robot has no table, where home or too many
/// poses break a rule, with how many each rule removed.
[[nodiscard]] PosePlan plan_poses(const RobotDescription& robot, const PoseTask& task,
                                  const OnPlanned& on_progress = {});

/// The campaign that an identification of such poses is given.
[[nodiscard]] identify::Campaign campaign_of_poses(const RobotDescription& robot);

}  // namespace sweepd
