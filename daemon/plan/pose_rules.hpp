#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/dh.hpp"

namespace sweepd {

/// A box along the axes of the robot's base, mm.
struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();

  [[nodiscard]] bool holds(const Eigen::Vector3d& point, double room_mm) const;
};

/// What poses have to keep to. Lengths in mm, in the robot's base.
struct PoseLimits {
  double margin_deg = 5;  ///< off the joint limits
  std::optional<Eigen::Vector3d> device_mm;
  /// Where the target's reflector looks, in the frame behind the last row, and half the angle
  /// within which it has to see the device; no angle: it looks everywhere.
  Eigen::Vector3d facing = Eigen::Vector3d::UnitZ();
  std::optional<double> cone_deg;
  double arm_radius_mm = 100;  ///< the line of sight stays so far off the arm; 0: it may cross it
  std::vector<Box> keep_out;
  std::optional<double> floor_mm;
  std::optional<double> column_mm;  ///< radius about axis 1, up to the height of axis 2
};

/// Why a pose is not taken, in the order in which that is looked at.
enum class PoseRule { keep_out, floor, column, cone, arm_between, way };
inline constexpr std::size_t kPoseRules = 6;
[[nodiscard]] std::string words(PoseRule rule);

/// Which poses an arm may take. The arm is the lines of its DH table, from the base over the axes
/// to the target, looked at every centimetre: boxes want half the arm's thickness added.
class PoseRules {
 public:
  PoseRules(const identify::Arm& arm, const PoseLimits& limits);

  /// The first rule that the pose breaks; `way`: the straight move of all joints from home does.
  [[nodiscard]] std::optional<PoseRule> broken(const std::vector<double>& angles_rad) const;
  /// The first that the arm's place breaks, whoever looks at it.
  [[nodiscard]] std::optional<PoseRule> in_the_way(const std::vector<double>& angles_rad) const;
  /// Whether nothing is in the way while all joints move evenly from one to the other, looked at
  /// every 5 degrees.
  [[nodiscard]] bool free_way(const std::vector<double>& from_rad,
                              const std::vector<double>& to_rad) const;

 private:
  struct Place {
    std::vector<Eigen::Vector3d> points;  ///< along the arm
    std::size_t beyond_elbow = 0;         ///< the first point behind the third axis
    std::size_t beyond_wrist = 0;         ///< the first on the way from the last axis to the target
    Eigen::Vector3d facing;
  };
  [[nodiscard]] Place place(const std::vector<double>& angles_rad) const;
  [[nodiscard]] std::optional<PoseRule> in_the_way(const Place& at) const;
  [[nodiscard]] std::optional<PoseRule> unseen(const Place& at) const;

  identify::Arm arm_;
  PoseLimits limits_;
  double shoulder_mm_ = 0;  // height of axis 2
};

}  // namespace sweepd
