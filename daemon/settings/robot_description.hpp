#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "identify/dh/dh.hpp"
#include "identify/sweeps/campaign.hpp"

namespace sweepd {

/// What a joint's angle and speed may be, in the controller's degrees, of a linear joint its mm;
/// infinite where that is not known.
struct JointLimits {
  double min_deg = -std::numeric_limits<double>::infinity();
  double max_deg = std::numeric_limits<double>::infinity();
  double max_speed_deg_s = std::numeric_limits<double>::infinity();  ///< at 100 %
  bool linear = false;                                               ///< described as linear

  /// What the numbers are in.
  [[nodiscard]] std::string_view unit() const { return linear ? "mm" : "degrees"; }

  [[nodiscard]] bool contain(double angle_deg) const {
    return min_deg <= angle_deg && angle_deg <= max_deg;
  }
};

/// A robot as its maker specifies it: config/robots/*.toml.
struct RobotDescription {
  std::string name;
  std::string source;  ///< where the figures come from; may be empty
  /// As many as joints, of linear ones mm; empty if the file has none.
  std::vector<double> home_deg;
  std::vector<JointLimits> limits;  ///< one a joint, 1 to 12
  /// The specified DH table, its thetas at `home_deg`; absent if the robot has none to compare
  /// with.
  std::optional<identify::Arm> arm;
  /// Standard deviation of what each joint gives way by under the weight that it carries, at its
  /// worst pose; as many as joints, zero where the file does not say.
  std::vector<double> sag_arcsec;
  /// What the joints carry, the payload last; empty where the file does not say.
  std::vector<identify::Load> loads;
  /// Which way is up in the base, unit.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();

  [[nodiscard]] std::size_t joints() const { return limits.size(); }
};

/// Reads and checks a robot description; throws ConfigError.
[[nodiscard]] RobotDescription load_robot(const std::filesystem::path& file);

}  // namespace sweepd
