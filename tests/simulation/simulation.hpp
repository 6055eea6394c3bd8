#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "identify/identification.hpp"
#include "identify/poses/pose.hpp"
#include "tests/simulation/gravity.hpp"
#include "tests/simulation/robot.hpp"
#include "tests/simulation/strokes.hpp"
#include "tests/simulation/world.hpp"

namespace simulation {

/// A campaign of an arm that is known exactly: what identify() gets, and what it ought to find. The
/// same seed gives the same bits.
class Simulation {
 public:
  Simulation(Robot robot, Strokes strokes, World world, std::uint32_t seed);

  /// In the order of time. Every stroke is a sweep whose joint and direction are known; of a stroke
  /// that all targets see, one sweep each.
  [[nodiscard]] std::vector<identify::Sweep> sweeps() const;
  /// Static poses at random, each joint up to `range_deg` from home, the targets in turn. Joints
  /// stand off what they tell as they do when locked (HomeError), anew at each pose.
  [[nodiscard]] std::vector<identify::Pose> poses(std::size_t count, double range_deg = 80) const;
  /// The same where the angles are told, one a joint.
  [[nodiscard]] std::vector<identify::Pose> poses_at(
      const std::vector<std::vector<double>>& angles_rad) const;
  /// The robot's links, as a description tells them.
  [[nodiscard]] std::vector<identify::Load> loads() const;
  /// What is known beforehand: the specified arm, the home that was meant, what is printed.
  [[nodiscard]] identify::Campaign campaign() const;

  /// The true arm as it stands, on average, where the encoders show `angles_rad`: thetas with what
  /// the gears and the load add there, as the DH numbers of the axes in that pose are.
  [[nodiscard]] identify::Arm arm_at(const std::vector<double>& angles_rad) const;
  /// The robot's base in the measurement frame.
  [[nodiscard]] const Eigen::Isometry3d& base() const { return base_; }
  [[nodiscard]] const Robot& robot() const { return robot_; }

 private:
  /// `of`: the angles of a pose, by its index and a source of randomness.
  template <typename Angles>
  [[nodiscard]] std::vector<identify::Pose> poses_where(std::size_t count, const Angles& of) const;
  /// How far the arm's joints have turned from home where its encoders show `angles`. `sides`: in
  /// which sense each joint moved last.
  [[nodiscard]] identify::Turns turns_at(const std::vector<double>& angles_rad,
                                         const std::vector<int>& sides) const;

  Robot robot_;
  Strokes how_;
  World world_;
  std::uint32_t seed_;
  identify::Chain chain_;
  Sag sag_;
  std::vector<std::vector<double>> homes_;
  Eigen::Isometry3d base_ = Eigen::Isometry3d::Identity();
  std::vector<std::array<double, 2>> phases_;  ///< of each joint's gear
  std::vector<int> sides_;                     ///< in which sense each joint came home at first
};

}  // namespace simulation
