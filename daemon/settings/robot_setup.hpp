#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "identify/identification.hpp"

namespace sweepd {

/// What is known of a robot before its first telegram.
struct RobotSetup {
  std::string name;
  std::size_t joints = 6;
  std::optional<RobotDescription> description;
  std::optional<SweepPlan> plan;
  SignalNames signals;
  DeviceSettings device;  ///< perhaps none

  /// One a joint; empty without a description.
  [[nodiscard]] std::vector<JointLimits> limits() const {
    return description ? description->limits : std::vector<JointLimits>{};
  }
};

/// Reads the files that the settings of a robot name. Throws ConfigError, also where the plan does
/// not fit the robot.
[[nodiscard]] RobotSetup load_setup(const RobotSettings& settings);

/// As above from files alone, either of which may be absent; without a description: six joints. The
/// name is that of the description's file: kr5-arc for kr5_arc.toml.
[[nodiscard]] RobotSetup load_setup(const std::optional<std::filesystem::path>& description,
                                    const std::optional<std::filesystem::path>& plan);

/// For the numerics: radians, joints counted from 0, the plan as the order of joints.
[[nodiscard]] identify::Campaign campaign(const RobotSetup& setup,
                                          const identify::Resolution& resolution);

}  // namespace sweepd
